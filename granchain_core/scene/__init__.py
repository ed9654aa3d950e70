"""Scenes: frozen descriptions in SI units, knobs, damping laws, presets, the displayed equation, states of chains."""

from .amplitude import Amplitude
from .description import Bead, hertz_stiffness
from .model import Scene
from .presets import ASSETS, scene, scene_names

__all__ = ["ASSETS", "Amplitude", "Bead", "Scene", "hertz_stiffness", "scene", "scene_names"]
