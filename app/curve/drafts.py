"""Drafts of the resonance curve from rest: a few points, drawn while a knob moves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from granchain_core import CurvePoint, Scene
from granchain_core.steady.curve.resonance_curve import draft_curve

from ..serve.computing.latest_wins import LatestWins
from ..serve.computing.turns import TurnFlag
from ..session.host import PageHost
from .computation import COARSE, grid
from .view import CurveFigure


class Drafts:
    """The drafts of one session; a newer draft replaces one that is waiting or being computed.

    `drawn` is called when a draft has replaced the curve from rest in the figure.
    """

    def __init__(self, host: PageHost, figure: CurveFigure, drawn: Callable[[], None]) -> None:
        self._figure = figure
        self._drawn = drawn
        self._jobs = LatestWins(partial(host.next_tick, self._draw), partial(host.next_tick, host.show_failure),
                                host.session.cpu_time)
        #: How many times drafts were dropped; a draft submitted before the last time is out of date.
        self._dropped = 0
        host.on_close(self._jobs.close)

    def submit(self, scene: Scene) -> None:
        """Compute and draw a draft for this scene."""
        self._jobs.submit(partial(self._computed, scene, self._dropped))

    def drop(self) -> None:
        """Drop every draft submitted so far, because the figure shows something else now."""
        self._dropped += 1
        self._jobs.cancel()

    @staticmethod
    def _computed(scene: Scene, dropped: int, stop: TurnFlag) -> Iterator[tuple[int, list[CurvePoint]]]:
        with stop.held():
            points = draft_curve(scene, grid(scene, COARSE), stop)
        yield dropped, points

    def _draw(self, drafted: tuple[int, list[CurvePoint]]) -> None:
        dropped, points = drafted
        if points and dropped == self._dropped:
            self._figure.redraw("rest", points)
            self._drawn()
