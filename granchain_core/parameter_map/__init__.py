"""Maps over two knobs: the regime and the largest forces of every cell, from rest."""

from .cells import Diagram
from .compute import diagram, iter_diagram
from .grid import Axis, Grid

__all__ = ["Axis", "Diagram", "Grid", "diagram", "iter_diagram"]
