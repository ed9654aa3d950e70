"""Periodic orbits as fixed points of the stroboscopic map, and their stability."""

from .orbit import Orbit, periodic_orbit, random_state

__all__ = ["Orbit", "periodic_orbit", "random_state"]
