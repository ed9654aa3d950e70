"""Facts about a scene for the page: slider ranges, the chain of a curve over f, and the beads of the paper's rig."""

from __future__ import annotations

from granchain_core import Scene, scene, scene_names
from granchain_core.scene import Bead
from granchain_core.scene.quantities import QUANTITIES

from .message_checks import is_number


def slider_range(current: Scene, name: str) -> tuple[float, float]:
    """Return a slider's range in the scene, or all values that granchain accepts if the scene gives none."""
    for knob, low, high in current.ranges:
        if knob == name:
            return low, high
    return QUANTITIES[name].low, QUANTITIES[name].high


def clicked_frequency(current: Scene, frequency: object) -> object:
    """Return the frequency of a click on the curve, limited to the slider's range; the knob checks any other value."""
    if not is_number(frequency):
        return frequency
    low, high = slider_range(current, "f")
    return round(min(max(frequency, low), high), 1)


def without_frequency(current: Scene) -> Scene:
    """Return the scene with f at a fixed value: the key of a curve or branch over f, whatever the knob f is set to."""
    return current.evolve(f=slider_range(current, "f")[0])


def rig_beads() -> tuple[Bead, ...]:
    """Return the beads of the paper's rig; the features that the paper states are drawn for scenes with these beads."""
    return scene("rig").pattern


def presets() -> list[dict[str, str]]:
    """Return the name and title of every scene."""
    return [{"name": name, "title": scene(name).title} for name in scene_names()]
