"""The resonance curves of the page: which are wanted, when they are computed, and their way to the figure."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from functools import partial

from panel.io import unlocked

from granchain_core import CurvePoint, Scene
from granchain_core.experiment import Measured, stated_features
from granchain_core.steady.curve import draft_curve

from ...page.layout import Views
from ...page.session import rig_beads, slider_range
from ...page.show import show_regime
from ...serve.compiler import CERTIFIED, COMPILER, CURVE, LIVE
from ...serve.queues import LatestWins, Stop
from .sweep import COARSE, DIRECTIONS, Progress, Sweep, grid, without_frequency

_QUIET = 350
"""Milliseconds without a movement before a curve is begun: nobody reads one while dragging."""
_SETTINGS = (*DIRECTIONS, "features")


class Curves:
    """A curve on the screen is computed; one that is scrolled away, switched off or unchanged is not."""

    def __init__(self, views: Views, later: Callable[..., None], after: Callable[..., None],
                 busy: Callable[[], bool]) -> None:
        self._views = views
        self._later = later
        self._after = after
        self._sweep = Sweep(self._report, lambda error: later(self._raise, error), busy)
        self._drafts = LatestWins(partial(later, self._draw_draft), partial(later, self._raise))
        self._begun = 0
        self._wanted = {name: name == "rest" for name in _SETTINGS}
        self._visible = True
        self._computed: dict[str, Scene] = {}
        self._due = 0
        self._lock = threading.Lock()
        self._buffer: list[Progress] = []
        self._key: Scene | None = None
        self._remaining: list[str] = []
        self._done = -1.0

    def open(self, scene: Scene) -> None:
        """Another scene: an empty figure over its frequencies."""
        self._computed.clear()
        self._views.curve.clear()
        self._views.curve.range(*slider_range(scene, "f"))
        self._wanted["features"] = scene.pattern == rig_beads()
        self._show_features(scene)
        self.changed(scene)

    def moved(self, scene: Scene) -> None:
        """Another knob than f moves: a draft is drawn at once, the curve itself when the knob rests."""
        self.changed(scene)
        if self._visible and self._wanted["rest"] and COMPILER.has(scene, CURVE):
            self._drafts.submit(partial(self._draft, scene, self._begun))

    @staticmethod
    def _draft(scene: Scene, begun: int, stop: Stop) -> Iterator[tuple[int, list[CurvePoint]]]:
        yield begun, draft_curve(scene, grid(scene, COARSE), stop)

    def _draw_draft(self, drafted: tuple[int, list[CurvePoint]]) -> None:
        begun, points = drafted
        if points and begun == self._begun:  # else the curve itself is on its way
            with unlocked():
                self._views.curve.redraw("rest", points)

    def changed(self, scene: Scene) -> None:
        """What is shown has changed."""
        self._sweep.cancel()
        self._due += 1
        self._after(_QUIET, self._begin_if_last, scene, self._due)

    def _begin_if_last(self, scene: Scene, due: int) -> None:
        if due != self._due:
            return
        if COMPILER.has(scene, LIVE, CERTIFIED, CURVE):
            self._begin(scene)
        else:
            self._after(_QUIET, self._begin_if_last, scene, due)

    def visible(self, visible: bool, scene: Scene) -> None:
        """The figure came on the screen or left it."""
        self._visible = visible
        if visible:
            self.changed(scene)
        else:
            self.stop()

    def choose(self, name: str, wanted: bool, scene: Scene) -> None:
        """Switch a direction or the stated features on or off."""
        if name not in self._wanted:
            return
        self._wanted[name] = wanted
        self._views.curvebar.display(**self._wanted)
        if name == "features":
            self._show_features(scene)
        else:
            self.changed(scene)

    def stop(self) -> None:
        """Give up what is being computed; what there is stays."""
        self._sweep.cancel()
        self._done = -1.0
        self._views.curvebar.display(done=-1.0)

    @property
    def computing(self) -> bool:
        """Whether a curve is under way."""
        return 0.0 <= self._done < 1.0

    def activities(self) -> list[tuple[str, str, str]]:
        """Name, state and detail of every direction, as it is at this moment."""
        found = []
        for name in DIRECTIONS:
            title = "resonance curve " + ("from rest" if name == "rest" else f"sweeping {name}")
            if not self._wanted[name]:
                found.append((title, "off", "not asked for"))
            elif self._computed.get(name) is not None and self._computed.get(name) == self._key:
                found.append((title, "there", "complete"))
            elif not self._visible:
                found.append((title, "off", "not on the screen"))
            elif name in self._remaining and self.computing:
                found.append((title, "computing", f"{100 * self._done:.0f} % of what is asked for"))
            else:
                found.append((title, "off", "waits until the knobs rest, or was stopped"))
        return found

    def close(self) -> None:
        """The visitor left."""
        self._sweep.cancel()
        self._drafts.close()

    def measured(self, measured: Measured | None) -> None:
        """The visitor's own data."""
        self._views.curve.measured(measured)

    def _begin(self, scene: Scene) -> None:
        """Compute what is wanted and not there yet; moving f alone makes nothing new."""
        key = without_frequency(scene)
        missing = [name for name in DIRECTIONS
                   if self._visible and self._wanted[name] and self._computed.get(name) != key]
        for name in missing:
            self._computed.pop(name, None)
        self._key = key
        shown = [name for name in DIRECTIONS if self._wanted[name]]
        with unlocked():
            self._views.curve.show_directions(shown)
            self._views.curve.begin(missing)
            self._views.curvebar.display(**self._wanted, done=0.0 if missing else -1.0)
        self._begun += bool(missing)
        self._remaining, self._done = list(missing), 0.0 if missing else -1.0
        self._sweep.start(scene, missing)

    def _show_features(self, scene: Scene) -> None:
        self._views.curvebar.display(**self._wanted)
        self._views.curve.features(stated_features() if self._wanted["features"] else [])

    def _report(self, progress: Progress) -> None:
        """From the worker thread: points are collected and drawn a few at a time."""
        with self._lock:
            self._buffer.append(progress)
            first = len(self._buffer) == 1
        if first:
            self._later(self._draw)

    def _draw(self) -> None:
        with self._lock:
            buffer, self._buffer = self._buffer, []
        points: dict[str, list[CurvePoint]] = {}
        for progress in buffer:
            points.setdefault(progress.direction, []).extend(progress.points)
        covers = {progress.direction for progress in buffer if progress.covers}
        with unlocked():
            for direction, new in points.items():
                self._views.curve.add(direction, new, direction in covers)
            for progress in buffer:
                if progress.complete and self._key is not None:
                    self._computed[progress.direction] = self._key
                    self._views.curve.finished(progress.direction)
                    show_regime(self._views)
            self._done = self._overall(buffer[-1])
            self._views.curvebar.display(done=self._done)

    def _overall(self, progress: Progress) -> float:
        """Progress over all directions of this request."""
        if progress.direction not in self._remaining:
            return -1.0
        place = self._remaining.index(progress.direction)
        return (place + progress.done) / len(self._remaining)

    @staticmethod
    def _raise(error: Exception) -> None:
        raise error
