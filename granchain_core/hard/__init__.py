"""The hard cases: where solvers of granular chains lie quietly, each with what must hold and how one knows."""

from .case import Case, Check, Figure, Picture, Trace, run_case
from .table import CASES

__all__ = ["CASES", "Case", "Check", "Figure", "Picture", "Trace", "run_case"]
