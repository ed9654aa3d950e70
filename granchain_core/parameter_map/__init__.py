"""Regime and largest forces over two knobs, every cell from rest."""

from .cells import Diagram
from .compute import diagram, iter_diagram
from .grid import Axis, Grid

__all__ = ["Axis", "Diagram", "Grid", "diagram", "iter_diagram"]
