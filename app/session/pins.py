"""Pinned motions as links, and the comparison of their numbers with those of the present motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from granchain_core import BadInput, Run, Scene, State
from granchain_core.scene.quantities import QUANTITIES

from ..format import figures_of, in_words, signed_in_words
from .initial_state import initial_state_text, read_initial_state
from .share import INITIAL_STATE, PINS, decode, encode

#: Names of the pins, in their order.
NAMES = "ABC"
_NOTHING = ["", "", ""]


@dataclass(frozen=True, eq=False)
class Pin:
    """A settled motion: its scene, and the state in which it began (None for rest)."""

    scene: Scene
    initial_state: State | None = None

    @property
    def text(self) -> str:
        """The pin as a link without a view."""
        return encode(self.scene, {}, {INITIAL_STATE: initial_state_text(self.initial_state)})


def pin_texts(pins: Sequence[Pin]) -> dict[str, str]:
    """Return the link fields of these pins."""
    return {name: pin.text for name, pin in zip(PINS, pins, strict=False)}


def read_pin(text: str) -> Pin:
    """Read the pin of a link's field. Raises `BadInput` for any bad value: a pin is read completely or not at all."""
    try:
        shown, fields, refused = decode(text)
        start = read_initial_state(fields[INITIAL_STATE], shown) if INITIAL_STATE in fields else None
    except BadInput:
        refused = [text]
    if refused:
        raise BadInput("A pin in the link is damaged and was left out.")
    return Pin(shown, start)


def setting_words(pin: Scene, now: Scene) -> str:
    """Return, in words, the scene and knobs by which a pinned scene differs from the present one."""
    parts = [pin.name] if pin.name != now.name else []
    for name, value in pin.knobs.items():
        if value != now.knobs[name] and name != "kappa":
            parts.append(f"{QUANTITIES[name].symbol or name} = {_knob(name, value)}")
    return ", ".join(parts) or "the same knobs"


def _knob(name: str, value: object) -> str:
    quantity = QUANTITIES[name]
    if not isinstance(value, (int, float)):
        return str(value)
    factor, unit = quantity.shown_in or (1.0, quantity.unit if quantity.unit != "1" else "")
    return f"{value / factor:.6g} {unit}".rstrip()


def compared_rows(now: Run, pinned: Sequence[Run | None]) -> list[dict[str, object]]:
    """Return rows of numbers: the present motion's, and for each pinned motion its own, the difference and the ratio.

    A pin that is still being computed is None here and has empty cells.
    """
    rows: list[dict[str, object]] = []
    for title, attribute, error in (("output force", "max_output_force", "output"),
                                    ("elastic part", "max_output_force_elastic", "elastic"),
                                    ("input force", "max_input_force", "input")):
        rows.append({"title": title, "now": _stated(now, attribute, error),
                     "pins": [_beside(now, run, attribute, error) for run in pinned]})
    rows.append({"title": "output / input", "now": _share(now),
                 "pins": [_NOTHING if run is None else [_share(run), "", _times(_ratio(now), _ratio(run))]
                          for run in pinned]})
    rows.append({"title": "motion", "now": now.regime.sentence,
                 "pins": [_NOTHING if run is None else [run.regime.sentence, "", ""] for run in pinned]})
    return rows


def _stated(run: Run, attribute: str, error: str) -> str:
    """Return a force to the figures that its error leaves, at most six."""
    value = float(getattr(run, attribute))
    relative = getattr(run.force_errors, error)
    return in_words(value, "N", figures_of(relative, 6))


def _beside(now: Run, run: Run | None, attribute: str, error: str) -> list[str]:
    if run is None:
        return _NOTHING
    here, pinned = float(getattr(now, attribute)), float(getattr(run, attribute))
    return [_stated(run, attribute, error), signed_in_words(here - pinned, "N"), _times(here, pinned)]


def _times(here: float, pinned: float) -> str:
    return f"× {here / pinned:.3g}" if pinned > 0.0 else "–"


def _ratio(run: Run) -> float:
    return run.max_output_force / run.max_input_force if run.max_input_force > 0.0 else 0.0


def _share(run: Run) -> str:
    return f"{100 * _ratio(run):.3g} %"
