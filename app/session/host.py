"""The interface of the dashboard that pages use; `Controller` implements it, and tests have their own."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from granchain_core import CurvePoint, Scene, State
from granchain_core.experiment import Difference, Measured

from .activities import Activity
from .session import Session

if TYPE_CHECKING:
    from granchain_core.fit.overlay import Overlay


class Caller(Protocol):
    """Calls with the document locked, until the session ends."""

    def next_tick(self, action: Callable[..., None], *args: object) -> None:
        """Call `action` with the document locked, as soon as that is possible; from any thread."""

    def call_later(self, seconds: float, action: Callable[..., None], *args: object) -> None:
        """Call `action` with the document locked, after `seconds`."""

    def on_close(self, action: Callable[[], object]) -> None:
        """Call `action` when the session ends; nothing is called by `next_tick` or `call_later` from then on."""


class WorkHost(Caller, Protocol):
    """What work in the background needs: calls, whether to wait for the picture, and whom to tell of errors.

    A `Task` waits while `awaiting_picture`; peak names, pins and sweeps, which compute much, also wait for a live step
    (`busy`).
    """

    @property
    def busy(self) -> bool:
        """Whether a picture is being computed."""

    @property
    def awaiting_picture(self) -> bool:
        """Whether a knob has moved and its steady picture is not there yet; false for a live run, which never ends."""

    def report_failure(self, error: Exception) -> None:
        """Show the visitor a failure that has no place on its own page."""

    def report_fault(self, error: Exception, sentence: str) -> None:
        """Log an error of granchain itself, and show `sentence`, which is empty where a page shows its own."""


class Host(WorkHost, Protocol):
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
        """The resonance curve from rest of the present knobs, in order of frequency; empty unless it is complete."""

    def show_measured_curve(self, measured: Measured | None) -> Difference | None:
        """Draw a measured curve over the resonance curve, or none; return how they differ if the latter is complete."""

    def show_measured_series(self, found: Overlay | None) -> None:
        """Draw a measured series over the force trains, or none."""

    def activities(self) -> list[Activity]:
        """Everything that is computed for this session, or could be."""

    def show(self, scene: Scene, state: State | None = None, mode: str = "settled") -> None:
        """Turn the knobs to `scene` and show its motion, from `state` or from where the visitor chose.

        In live mode the run goes on with the new knobs, unless a state is given. Raises `BadInput` for a mode other
        than "settled" and "live".
        """

    def address_changed(self) -> None:
        """Send the page its new address: something that a link carries has changed, but no knob."""

    def open(self, scene: Scene, state: State | None, curves: str) -> None:
        """Open a scene, maybe another preset, settled from `state` or from rest.

        `curves` are those of a link; an empty text leaves them as they are.
        """
