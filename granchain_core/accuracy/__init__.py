"""The cost of accuracy on this machine: error against time for every method, and the time per effect."""

from .compared_methods import MeasuredMethod, compared_methods
from .measurements import Row, WorkPrecision, cheapest
from .naive import Lesson, Naive
from .work_precision import work_precision

__all__ = ["Lesson", "MeasuredMethod", "Naive", "Row", "WorkPrecision", "cheapest", "compared_methods",
           "work_precision"]
