"""Periodic orbits as fixed points of the stroboscopic map, and their stability."""

from .orbit import Orbit, periodic_orbit

__all__ = ["Orbit", "periodic_orbit"]
