"""Facts about a scene for the page: ranges of sliders, the chain of a curve over f, the beads of the paper's rig."""

from __future__ import annotations

from granchain_core import Scene, scene, scene_names
from granchain_core.scene import Bead
from granchain_core.scene.quantities import QUANTITIES

from .message_checks import is_number


def slider_range(current: Scene, name: str) -> tuple[float, float]:
    """The scene's range of a slider, or all values that granchain accepts if the scene has none."""
    for knob, low, high in current.ranges:
        if knob == name:
            return low, high
    return QUANTITIES[name].low, QUANTITIES[name].high


def clicked_frequency(current: Scene, frequency: object) -> object:
    """The frequency of a click on the curve, inside the slider's range; any other value is left to the knob's check."""
    if not is_number(frequency):
        return frequency
    low, high = slider_range(current, "f")
    return round(min(max(frequency, low), high), 1)


def without_frequency(current: Scene) -> Scene:
    """The scene with f at a fixed value: the key of a curve or branch over f, whatever the value of the knob f."""
    return current.evolve(f=slider_range(current, "f")[0])


def rig_beads() -> tuple[Bead, ...]:
    """The beads of the paper's rig; the features that the paper states are drawn for scenes with these beads."""
    return scene("rig").pattern


def presets() -> list[dict[str, str]]:
    """Name and title of every scene."""
    return [{"name": name, "title": scene(name).title} for name in scene_names()]
