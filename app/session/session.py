"""The state of one visitor's page: scene, mode, start, the last good picture, and a sentence if something failed.

No Panel and no Bokeh in here, so that every rule of the page can be tested without a browser.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from granchain_core import BadInput, Scene, Settled, State, scene, scene_names
from granchain_core.quantities import QUANTITIES
from granchain_core.scene import Bead

from ..serve.work.cpu_time import CpuTime
from .message_checks import is_number, quoted
from .pins import Pin, pin_texts
from .share import BROWSER_FIELDS, QUESTION, SPEEDS, START, VIEW, VIEW_VALUES, encode, pins_in
from .starts import start_text
from .switches import ACCOUNT_SWITCH, changes

MODES = VIEW_VALUES["mode"]
STARTS = VIEW_VALUES["start"]


@dataclass
class Session:
    """The state of one page; methods change it or raise `BadInput` and leave it as it was.

    `cpu_time` is the processor time of its pictures, and `insisted` the scene that is computed however long it takes.
    `started_from` is the state in which the motion on the screen began, None for rest; `story` is "NAME.STEP"
    (`story_to_settle` where its motion has still to be settled from others), and `question` the Analysis page's with
    its values, as in a link.
    """

    scene: Scene = field(default_factory=lambda: scene("sec2"))
    mode: str = "settled"
    start: str = "rest"
    theme: str = "auto"
    scale: str = "same"
    curves: str = "auto"
    place: dict[str, str] = field(default_factory=dict)
    speed: float = 1.0
    playing: bool = True
    settled: Settled | None = None
    started_from: State | None = None
    sentence: str = ""
    notice: str = ""
    energy_account: bool = False
    remembered: dict[str, Any] = field(default_factory=dict)
    cpu_time: CpuTime = field(default_factory=CpuTime)
    insisted: Scene | None = None
    pins: tuple[Pin, ...] = ()
    story: str = ""
    story_to_settle: bool = False
    question: str = ""

    @property
    def link(self) -> str:
        """The query string that brings back what is on the screen: scene, knobs, where the motion began, the view."""
        view = {name: setting.text(getattr(self, setting.attribute))
                for name, setting in VIEW.items() if name not in BROWSER_FIELDS}
        began = self.started_from if self.mode == "settled" else None
        texts = {START: start_text(began), "story": self.story, QUESTION: self.question, **pin_texts(self.pins)}
        return encode(self.scene, view, texts)

    def apply_view(self, fields: Mapping[str, str]) -> None:
        """Take over the view settings of a link; one that is not among its fields gets its default."""
        for name, setting in VIEW.items():
            setattr(self, setting.attribute, setting.read(fields.get(name, setting.values[0])))

    @property
    def pins_left_out(self) -> str:
        """A sentence where the link has no room for all pins; empty where it has."""
        kept = pins_in(self.link)
        left = len(self.pins) - kept
        if not left:
            return ""
        return (f"The link has room for {kept} of {len(self.pins)} pins, because the states in which long chains begin "
                f"take much of it: {'the last is' if left == 1 else 'the others are'} not in the link.")

    def change(self, name: str, value: object) -> None:
        """Turn knob `name` to `value`."""
        self.scene = self.scene.evolve(**{name: value})

    def switch(self, name: str, on: bool) -> None:
        """Switch an effect on or off; the values of its knobs are kept until it is switched on again."""
        if name == ACCOUNT_SWITCH:
            self.energy_account = on
            return
        moved = changes(name, on, self.scene, self.remembered)
        before = {knob: self.scene.knobs[knob] for knob in moved if knob != "kappa"}
        self.scene = self.scene.evolve(**moved)
        if not on:
            self.remembered.update(before)

    def restore(self, name: str) -> None:
        """Turn knob `name` back to its value in the preset."""
        preset = scene(self.scene.name).knobs
        if name not in preset:
            raise BadInput(f"There is no knob {quoted(name)} to put back.")
        self.change(name, preset[name])

    def choose(self, name: object) -> None:
        """Open another preset, in the same mode."""
        self.scene = scene(name if isinstance(name, str) else str(name)[:60])
        self.settled = None
        self.remembered.clear()

    def open(self, opened: Scene) -> None:
        """Show a scene, maybe of another preset, settled from rest."""
        if opened.name != self.scene.name:
            self.settled = None
            self.remembered.clear()
        self.scene, self.mode, self.start = opened, "settled", "rest"

    def set_mode(self, mode: object) -> None:
        """`settled` or `live`."""
        self.mode = _one_of("mode", mode, MODES)

    def set_start(self, start: object) -> None:
        """Where settled pictures start: from rest or from where the chain was."""
        self.start = _one_of("start", start, STARTS)

    def set_scale(self, scale: object) -> None:
        """One scale for all pictures of the scene, or every picture fitted to its frame."""
        self.scale = _one_of("scale", scale, VIEW_VALUES["scale"])

    def set_speed(self, speed: object) -> None:
        """Set the drive periods shown in a second to one of `SPEEDS`."""
        if not is_number(speed) or speed not in SPEEDS:
            known = ", ".join(f"{speed:g}" for speed in sorted(SPEEDS))
            raise BadInput(f"speed {quoted(speed)} is not one of {known} drive periods a second.")
        self.speed = float(speed)

    def previous_state(self, scene: Scene) -> State | None:
        """The state from which the next settled picture, of `scene`, starts; None is rest."""
        if self.start == "rest" or self.settled is None:
            return None
        state = self.settled.state
        return state if len(state.displacement) == scene.N else None


def slider_range(current: Scene, name: str) -> tuple[float, float]:
    """The scene's range of a slider, or all values that granchain accepts if the scene has none."""
    for knob, low, high in current.ranges:
        if knob == name:
            return low, high
    return QUANTITIES[name].low, QUANTITIES[name].high


def clicked_frequency(current: Scene, frequency: object) -> object:
    """The frequency of a click on the curve, inside the slider's range; the knob refuses what is not a number."""
    if not is_number(frequency):
        return frequency
    low, high = slider_range(current, "f")
    return round(min(max(frequency, low), high), 1)


def without_frequency(current: Scene) -> Scene:
    """The scene with f at a fixed value. It identifies a curve or branch over f, whatever the knob f is set to."""
    return current.evolve(f=slider_range(current, "f")[0])


def rig_beads() -> tuple[Bead, ...]:
    """The beads of the paper's rig: its stated features are drawn for scenes with these beads."""
    return scene("rig").pattern


def _one_of(what: str, value: object, known: tuple[str, ...]) -> str:
    if value in known:
        return str(value)
    raise BadInput(f"{what} {quoted(value)} is not one of {', '.join(known)}.")


def presets() -> list[dict[str, str]]:
    """Name and title of every scene."""
    return [{"name": name, "title": scene(name).title} for name in scene_names()]
