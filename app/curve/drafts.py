"""Drafts of the resonance curve from rest: a few points, drawn while a knob moves."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from granchain_core import CurvePoint, Scene
from granchain_core.steady.curve.resonance_curve import draft_curve

from ..serve.computing.latest_wins import LatestWins
from ..serve.computing.turns import TurnFlag
from ..session.host import PageHost
from .sweep import COARSE, grid
from .view import CurveFigure


class Drafts:
    """The drafts of one session; a newer draft replaces one that waits or is being computed."""

    def __init__(self, host: PageHost, figure: CurveFigure) -> None:
        self._figure = figure
        self._jobs = LatestWins(partial(host.next_tick, self._draw), partial(host.next_tick, host.show_failure),
                                host.session.cpu_time)
        #: How many curves have been begun; a draft from before the last of them is out of date.
        self._curves_begun = 0
        host.on_close(self._jobs.close)

    def submit(self, scene: Scene) -> None:
        """Compute and draw a draft for this scene."""
        self._jobs.submit(partial(self._computed, scene, self._curves_begun))

    def curve_begun(self) -> None:
        """The curve itself is being computed: draw no draft that was submitted before."""
        self._curves_begun += 1

    @staticmethod
    def _computed(scene: Scene, curves_begun: int, stop: TurnFlag) -> Iterator[tuple[int, list[CurvePoint]]]:
        with stop.held():
            points = draft_curve(scene, grid(scene, COARSE), stop)
        yield curves_begun, points

    def _draw(self, drafted: tuple[int, list[CurvePoint]]) -> None:
        curves_begun, points = drafted
        if points and curves_begun == self._curves_begun:
            self._figure.redraw("rest", points)
