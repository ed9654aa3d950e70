"""Methods and the engine that carries a state through time with one of them."""

from .engine import Engine, State
from .methods import METHODS, Method, Setting, certified, live, method_for

__all__ = ["METHODS", "Engine", "Method", "Setting", "State", "certified", "live", "method_for"]
