"""Observers, models (3) and (4): a chain pushed by a measured force, and whether such a chain finds the true state."""

from .figure_11 import Figure11, figure_11
from .stability import ObserverPoint, ObserverStability, Threshold, observer_stability
from .twin import Twin, twin

__all__ = [
    "Figure11", "ObserverPoint", "ObserverStability", "Threshold", "Twin", "figure_11", "observer_stability", "twin",
]
