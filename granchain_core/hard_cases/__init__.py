"""The hard cases, in which solvers of granular chains fail silently, with measurements, limits and oracles."""

from .case import Case, Check, Measurement, Picture, Trace, run_case
from .table import CASES

__all__ = ["CASES", "Case", "Check", "Measurement", "Picture", "Trace", "run_case"]
