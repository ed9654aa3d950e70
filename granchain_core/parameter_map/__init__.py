"""The parameter map: regime and largest forces over two knobs, every cell from rest.

In code a parameter map is a `Diagram`, which `diagram` computes, and `granchain map` on the command line. The diagram
over one knob, the bifurcation diagram, is in `analysis/strobe_diagram.py`.
"""

from .cells import Diagram
from .compute import diagram, iter_diagram
from .grid import Axis, Grid

__all__ = ["Axis", "Diagram", "Grid", "diagram", "iter_diagram"]
