"""Two knobs at once: regime and largest forces over a grid, its boundaries, and all attractors of one setting."""

from .attractors import Attractor, attractors, listing
from .cells import Diagram
from .compute import diagram, iter_diagram
from .grid import Axis, Grid

__all__ = ["Attractor", "Axis", "Diagram", "Grid", "attractors", "diagram", "iter_diagram", "listing"]
