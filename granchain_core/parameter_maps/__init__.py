"""The parameter map: regime and largest forces over two knobs, every cell from rest.

The bifurcation diagram over one knob is in `analysis/bifurcation_diagram.py`.
"""

from ..former_names import of_module
from .cells import ParameterMap
from .compute import iter_parameter_map, parameter_map
from .grid import Axis, Grid

__all__ = ["Axis", "Grid", "ParameterMap", "iter_parameter_map", "parameter_map"]

__getattr__ = of_module(__name__)
