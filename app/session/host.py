"""The dashboard's interface for its pages; `Controller` implements it, and so do the hosts of tests."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from granchain_core import CurvePoint, Scene, State
from granchain_core.experiment import Difference, Measured

from .activities import Activity
from .session import Session

if TYPE_CHECKING:
    from granchain_core.fitting.overlay import Overlay


class Caller(Protocol):
    """Calls with the document locked, until the session ends."""

    def next_tick(self, action: Callable[..., None], *args: object) -> None:
        """Call `action` with the document locked, as soon as that is possible; called from any thread."""

    def call_later(self, seconds: float, action: Callable[..., None], *args: object) -> None:
        """Call `action` with the document locked, after `seconds`."""

    def on_close(self, action: Callable[[], object]) -> None:
        """Call `action` when the session ends; after that, `next_tick` and `call_later` call nothing."""


class WorkHost(Caller, Protocol):
    """The host of background work: it calls back, says whether work must wait for the picture, and reports errors.

    A `Task` waits while `awaiting_picture` is True. Peak names, pins and sweeps compute a lot, so they also wait for
    live steps (`busy`).
    """

    @property
    def busy(self) -> bool:
        """Whether a picture is being computed."""

    @property
    def awaiting_picture(self) -> bool:
        """Whether a knob has moved and its settled picture is not ready; False for a live run, which never ends."""

    def show_failure(self, error: Exception) -> None:
        """Show the visitor a failure that a page has no place for."""

    def report_fault(self, error: Exception, sentence: str, fault: str = "") -> None:
        """Log an error of granchain itself, and show `sentence` with an id.

        The sentence is empty if the page itself shows one, with the id `fault`.
        """

    def log_failed_computation(self, error: Exception, fault: str) -> None:
        """Log a computation that could not be finished; a page shows its message with the id `fault`."""


class PageHost(WorkHost, Protocol):
    """One session's dashboard, as its pages see it.

    Any thread may call `next_tick` and read the flags `busy`, `awaiting_picture` and `curve_computing`. Everything else
    is used with the document locked.
    """

    session: Session

    @property
    def overlays(self) -> tuple[str, ...]:
        """The overlays, by name."""

    @property
    def curve_computing(self) -> bool:
        """Whether a resonance curve is being computed."""

    def complete_curve(self) -> list[CurvePoint]:
        """Return the resonance curve from rest of the present knobs, by frequency; empty unless it is complete."""

    def show_measured_curve(self, measured: Measured | None) -> Difference | None:
        """Draw a measured curve over the resonance curve, or remove it; return its difference from a complete curve."""

    def show_measured_series(self, overlay: Overlay | None) -> None:
        """Draw a measured series over the force trains, or remove it."""

    def activities(self) -> list[Activity]:
        """Return all computations of this session, including those that are switched off."""

    def turn_knobs(self, scene: Scene, state: State | None = None, mode: str = "settled") -> None:
        """Turn the knobs of the present preset to those of `scene`; show its motion, from `state` or the chosen start.

        In live mode, the run continues with the new knobs unless a state is given. `mode` is "settled" or "live"; any
        other raises `BadInput`.
        """

    def address_changed(self) -> None:
        """Send the browser its new address, because a field of the link other than a knob has changed."""

    def open_scene(self, scene: Scene, state: State | None, curves: str) -> None:
        """Open a scene, possibly another preset, settled from `state` or from rest; this ends a live run.

        `curves` is the field of a link; if it is empty, the same curves stay selected.
        """
