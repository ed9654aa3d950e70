"""The state of one session: scene, mode, start, the last good picture, and a message if something failed.

This module uses neither Panel nor Bokeh, so that every rule of the page can be tested without a browser. The state is
changed by the controller and its parts (`app/dashboard`) and by the pages *analysis*, *data*, *effects*, *map* and
*stories*, always with the document locked.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from granchain_core import BadInput, Scene, Settled, State, scene
from granchain_core.experiment import Measured, Series

from ..serve.computing.cpu_time import CpuTime
from .initial_state import initial_state_text
from .message_checks import check_choice, is_number, quoted
from .pins import Pin, pin_texts
from .share import BROWSER_FIELDS, DEFAULT_SCENE, INITIAL_STATE, QUESTION, SPEEDS, VIEW, VIEW_VALUES, encode, pins_in
from .switches import ACCOUNT_SWITCH, changes

MODES = VIEW_VALUES["mode"]
STARTS = VIEW_VALUES["start"]


@dataclass
class Session:
    """The state of one open web page. A method changes the state, or raises `BadInput` and leaves the state unchanged.

    share.py lists the values of those fields that are part of a link (`VIEW`).
    """

    #: The chain with the present knobs.
    scene: Scene = field(default_factory=lambda: scene(DEFAULT_SCENE))
    #: "settled" to show the steady motion, "live" for a run that continues while knobs move.
    mode: str = "settled"
    #: The start of a settled picture: "rest", or "previous" for the state of the previous picture.
    start: str = "rest"
    #: The theme requested by a link; "auto" leaves it to the browser.
    theme: str = "auto"
    #: "same" if all pictures of the scene are drawn to one scale, "fit" if each is drawn to its largest values.
    scale: str = "same"
    #: The curves in the figure of the resonance curve: "auto" for the scene's default, or names joined by dots, for
    #: example "rest.up".
    curves: str = "auto"
    #: The "tab" and "page" (an overlay) that the address opens, if it names them.
    place: dict[str, str] = field(default_factory=dict)
    #: Drive periods shown per second.
    speed: float = 1.0
    #: Whether the motion is played; a paused live run computes nothing.
    playing: bool = True
    #: The last settled picture; the knobs may have moved since. None until this preset has one.
    settled: Settled | None = None
    #: The state in which the motion on the screen began; None for rest.
    initial_state: State | None = None
    #: A message to the visitor, for example why a value was refused; `Sentences` removes it.
    sentence: str = ""
    #: A message to the visitor until the next picture, for example that kernels are being compiled.
    notice: str = ""
    #: Whether the energy account is computed after each settled picture.
    energy_account: bool = False
    #: Values that knobs had before their effect was switched off; switching it on again restores them.
    remembered: dict[str, Any] = field(default_factory=dict)
    #: The processor time used by the session's pictures; it decides whose turn is next.
    cpu_time: CpuTime = field(default_factory=CpuTime)
    #: The scene whose picture the visitor has requested no matter how long it takes.
    insisted: Scene | None = None
    #: The visitor's measurement, which is drawn over the figures and saved with a run.
    measured: Measured | Series | None = None
    #: The pinned pictures.
    pins: tuple[Pin, ...] = ()
    #: The step of a story that is shown, "NAME.STEP"; empty for none.
    story: str = ""
    #: Whether the frequencies of `StoryStep.via` must still be settled before the motion of that step is known.
    story_to_settle: bool = False
    #: The question of the Analysis page with its values, as it is written in a link.
    question: str = ""
    #: The name of this session in the log; empty outside a server.
    label: str = ""

    @property
    def link(self) -> str:
        """The query string that restores the screen: scene, knobs, initial state and view."""
        view = {name: setting.text(getattr(self, setting.attribute))
                for name, setting in VIEW.items() if name not in BROWSER_FIELDS}
        began = self.initial_state if self.mode == "settled" else None
        texts = {INITIAL_STATE: initial_state_text(began), "story": self.story, QUESTION: self.question,
                 **pin_texts(self.pins)}
        return encode(self.scene, view, texts)

    def apply_view(self, fields: Mapping[str, str]) -> None:
        """Apply the view settings of a link; a setting that the link does not have gets its default."""
        for name, setting in VIEW.items():
            setattr(self, setting.attribute, setting.read(fields.get(name, setting.values[0])))

    @property
    def pins_left_out(self) -> str:
        """A sentence if the link has no room for all pins; otherwise empty."""
        kept = pins_in(self.link)
        left = len(self.pins) - kept
        if not left:
            return ""
        return (f"The link has room for {kept} of {len(self.pins)} pins, because the initial states of long chains "
                f"take up much of it: {'the last is' if left == 1 else 'the others are'} not in the link.")

    def change(self, name: str, value: object) -> None:
        """Set knob `name` to `value`."""
        self.scene = self.scene.evolve(**{name: value})

    def switch(self, name: str, on: bool) -> None:
        """Switch an effect on or off; the values of its knobs are kept until the effect is switched on again."""
        if name == ACCOUNT_SWITCH:
            self.energy_account = on
            return
        moved = changes(name, on, self.scene, self.remembered)
        before = {knob: self.scene.knobs[knob] for knob in moved if knob != "kappa"}
        self.scene = self.scene.evolve(**moved)
        if not on:
            self.remembered.update(before)

    def restore(self, name: str) -> None:
        """Restore knob `name` to its value in the preset."""
        preset = scene(self.scene.name).knobs
        self.change(name, preset[check_choice("knob", name, preset)])

    def choose(self, name: object) -> None:
        """Open another preset, in the same mode."""
        self.scene = scene(name if isinstance(name, str) else str(name)[:60])
        self.settled = None
        self.remembered.clear()

    def open(self, opened: Scene) -> None:
        """Show a scene, possibly of another preset, settled from rest."""
        if opened.name != self.scene.name:
            self.settled = None
            self.remembered.clear()
        self.scene, self.mode, self.start = opened, "settled", "rest"

    def set_mode(self, mode: object) -> None:
        """Set the mode, `settled` or `live`."""
        self.mode = check_choice("mode", mode, MODES)

    def set_start(self, start: object) -> None:
        """Set the start of settled pictures, `rest` or `previous`."""
        self.start = check_choice("start", start, STARTS)

    def set_scale(self, scale: object) -> None:
        """Set the scale of pictures, `same` or `fit`."""
        self.scale = check_choice("scale", scale, VIEW_VALUES["scale"])

    def set_speed(self, speed: object) -> None:
        """Set the drive periods shown per second to one of `SPEEDS`."""
        if not is_number(speed) or speed not in SPEEDS:
            known = ", ".join(f"{speed:g}" for speed in sorted(SPEEDS))
            raise BadInput(f"speed {quoted(speed)} is not one of {known} drive periods per second.")
        self.speed = float(speed)

    def previous_state(self, scene: Scene) -> State | None:
        """Return the state from which the next settled picture of `scene` starts (None for rest)."""
        if self.start == "rest" or self.settled is None:
            return None
        state = self.settled.state
        return state if len(state.displacement) == scene.N else None
