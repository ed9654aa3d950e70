"""Time integration: the table of methods, and the engine that advances a state with one of them."""

from ..state import State
from .counts import Counts
from .engine import Engine
from .methods import METHODS, Method, Setting, adaptive_setting, fixed_step_setting, method_for

__all__ = ["METHODS", "Counts", "Engine", "Method", "Setting", "State", "adaptive_setting", "fixed_step_setting",
           "method_for"]
