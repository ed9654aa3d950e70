"""What accuracy costs: error against time for every method, on this machine, now; and what each effect costs."""

from .naive import Lesson, Naive
from .ways import MeasuredMethod, ways
from .work_precision import Row, WorkPrecision, cheapest, work_precision

__all__ = ["Lesson", "MeasuredMethod", "Naive", "Row", "WorkPrecision", "cheapest", "ways", "work_precision"]
