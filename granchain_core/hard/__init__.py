"""The hard cases, in which solvers of granular chains fail silently: what must hold in each, and an oracle."""

from .case import Case, Check, Measurement, Picture, Trace, run_case
from .table import CASES

__all__ = ["CASES", "Case", "Check", "Measurement", "Picture", "Trace", "run_case"]
