"""The parameter map: regime and largest forces over two knobs, every cell from rest.

`diagram` and `Diagram` are older names of `parameter_map` and `ParameterMap`. The bifurcation diagram, over one knob,
is in `analysis/bifurcation_diagram.py`.
"""

from .cells import ParameterMap
from .compute import iter_parameter_map, parameter_map
from .grid import Axis, Grid

Diagram, diagram, iter_diagram = ParameterMap, parameter_map, iter_parameter_map

__all__ = ["Axis", "Grid", "ParameterMap", "iter_parameter_map", "parameter_map"]
