"""Time integration: the table of methods, and the engine that advances a state with one of them."""

from .counts import Counts
from .engine import Engine
from .methods import (
    METHODS,
    Method,
    Setting,
    adaptive_setting,
    fixed_step_setting,
    following_setting,
    method_for,
)

__all__ = ["METHODS", "Counts", "Engine", "Method", "Setting", "adaptive_setting", "fixed_step_setting",
           "following_setting", "method_for"]
