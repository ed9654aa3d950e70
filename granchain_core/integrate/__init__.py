"""Time integration: from a scene to scaled numbers, the table of methods, the engine that carries a state, batches."""

from ..former_names import of_module
from .counts import Counts
from .engine import Engine
from .methods import (
    METHODS,
    Method,
    MethodSetting,
    dop853_setting,
    fixed_step_setting,
    following_setting,
    method_for,
)

__all__ = ["METHODS", "Counts", "Engine", "Method", "MethodSetting", "dop853_setting", "fixed_step_setting",
           "following_setting", "method_for"]

__getattr__ = of_module(__name__)
