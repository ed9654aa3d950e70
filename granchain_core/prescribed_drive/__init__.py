"""Chains whose driver has a given motion: chirp, burst, tones, noise, a measured series (docs/scenes.md)."""

from .driven import Driven, drive
from .signal import Signal

__all__ = ["Driven", "Signal", "drive"]
