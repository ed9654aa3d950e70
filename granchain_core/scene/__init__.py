"""Scenes: frozen descriptions in SI, knobs and damping laws, presets, the equation on screen; states of chains."""

from .amplitude import Amplitude
from .description import Bead, hertz_stiffness
from .model import Scene
from .presets import ASSETS, scene, scene_names

__all__ = ["ASSETS", "Amplitude", "Bead", "Scene", "hertz_stiffness", "scene", "scene_names"]
