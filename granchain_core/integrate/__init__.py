"""Time integration: from a scene to scaled numbers, the table of methods, the engine that carries a state, batches."""

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
from .methods import Setting as Setting

__all__ = ["METHODS", "Counts", "Engine", "Method", "MethodSetting", "dop853_setting", "fixed_step_setting",
           "following_setting", "method_for"]
