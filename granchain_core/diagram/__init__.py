"""Two knobs at once: a map of regimes and largest forces, bifurcation curves, and all attractors of one setting."""

from .attractor import Attractor, Attractors, listing
from .attractors import attractors
from .boundaries import BoundaryCurve, boundaries
from .boundary import BoundaryPoint, boundary_curves, boundary_point
from .cells import Diagram
from .compute import diagram, iter_diagram
from .grid import Axis, Grid

__all__ = [
    "Attractor", "Attractors", "Axis", "BoundaryCurve", "BoundaryPoint", "Diagram", "Grid", "attractors", "boundaries",
    "boundary_curves", "boundary_point", "diagram", "iter_diagram", "listing",
]
