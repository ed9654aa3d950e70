"""What accuracy costs: error against time for every method, on this machine, now; and what each effect costs."""

from .naive import Lesson, Naive
from .ways import Way, ways
from .work_precision import Row, WorkPrecision, cheapest, work_precision

__all__ = ["Lesson", "Naive", "Row", "Way", "WorkPrecision", "cheapest", "ways", "work_precision"]
