"""Chains whose driver has a given motion: chirp, burst, tones, noise, or a measured series."""

from .driven import Driven, drive
from .signal import Signal

__all__ = ["Driven", "Signal", "drive"]
