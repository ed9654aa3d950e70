"""Time integration: scaling of a scene, the table of methods, the engine that advances a state, and batches."""

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
