"""Methods and the engine that carries a state through time with one of them."""

from ..state import State
from .counts import Counts
from .engine import Engine
from .methods import METHODS, Method, Setting, adaptive_setting, fixed_step_setting, method_for

__all__ = ["METHODS", "Counts", "Engine", "Method", "Setting", "State", "adaptive_setting", "fixed_step_setting",
           "method_for"]
