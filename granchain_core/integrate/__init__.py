"""Methods and the engine that carries a state through time with one of them."""

from ..state import State
from .counts import Counts
from .engine import Engine
from .methods import METHODS, Method, Setting, certified, live, method_for

__all__ = ["METHODS", "Counts", "Engine", "Method", "Setting", "State", "certified", "live", "method_for"]
