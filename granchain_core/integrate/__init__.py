"""Methods and the engine that carries a state through time with one of them."""

from .engine import Engine, State
from .methods import METHODS, Method, Setting, method_for

__all__ = ["METHODS", "Engine", "Method", "Setting", "State", "method_for"]
