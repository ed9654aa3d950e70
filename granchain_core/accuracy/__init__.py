"""What accuracy costs: error against time for every method, on this machine, now."""

from .work_precision import Row, WorkPrecision, work_precision

__all__ = ["Row", "WorkPrecision", "work_precision"]
