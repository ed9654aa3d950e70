"""The cost of accuracy on this machine: error against time for every method, and the time per effect."""

from .compared_methods import MeasuredMethod, compared_methods
from .measurements import Row, WorkPrecision, cheapest
from .naive import NaiveComparison, NaiveLine
from .work_precision import work_precision

__all__ = [
           "MeasuredMethod",
           "NaiveComparison",
           "NaiveLine",
           "Row",
           "WorkPrecision",
           "cheapest",
           "compared_methods",
           "work_precision",
]
