"""Two knobs at once: regime and largest forces over a grid, its boundaries, and all attractors of one setting."""

from .cells import Diagram
from .compute import diagram, iter_diagram
from .grid import Axis, Grid

__all__ = ["Axis", "Diagram", "Grid", "diagram", "iter_diagram"]
