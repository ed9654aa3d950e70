"""Periodic orbits as fixed points of the stroboscopic map, and their stability."""

from .orbit import Orbit, periodic_orbit
from .response import Response, response

__all__ = ["Orbit", "Response", "periodic_orbit", "response"]
