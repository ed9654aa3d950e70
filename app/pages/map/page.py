"""The Map tab of one visitor: the diagram over f and A0 while it is looked at, and all attractors of the setting."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from panel.io import unlocked

from granchain_core import BadInput, Cancelled, NumbersFailed, Scene, Settled, settling
from granchain_core.diagram import Attractor, Axis, Grid, attractors, iter_diagram
from granchain_core.diagram.cells import cell_of, empty_cells
from granchain_core.integrate.engine import new_stop
from granchain_core.orbits.compiled import ORBIT_PIECE

from ...page.background import Background
from ...page.frames import samples_for
from ...page.session import slider_range
from ...serve.compiler import CERTIFIED, CURVE, LIVE
from ...serve.queues import Stop, in_thread
from .view import cells_message, described, head_message

if TYPE_CHECKING:
    from ...page.controller import Controller

COLUMNS, ROWS = 60, 40
"""Cells over f and over A0: coarse enough to be there in some ten seconds on one core."""
_QUIET = 700
"""Milliseconds without a movement of another knob before a new diagram is begun."""
_BATCH, _PATIENCE = 0.25, 0.01
"""Seconds between two lots of cells, and between looks whether the picture in front is done."""
_RANDOM_STATES, _FEW = 64, 12
"""Random states of a search, and those of a scene that has to be settled without lanes."""


def page_grid(scene: Scene) -> Grid:
    """The diagram of a scene over the ranges of its sliders; it is the same wherever f and A0 stand."""
    (f0, f1), (a0, a1) = slider_range(scene, "f"), slider_range(scene, "A0")
    low = scene.evolve(f=f0, A0=a0)
    return Grid(low, Axis.of("f", np.linspace(f0, f1, COLUMNS)), Axis.of("A0", np.geomspace(a0, a1, ROWS).tolist()))


class MapTab(Background):
    """While the tab is on the screen its diagram is computed; nothing is while it is not."""

    def __init__(self, page: Controller) -> None:
        self._page = page
        self._visible = False
        self._stop: Stop = new_stop()
        self._search: Stop = new_stop()
        self._grid: Grid | None = None
        self._cells: np.ndarray[Any, Any] = np.zeros(0)
        self._shown: list[dict[str, Any]] = []
        self._due = 0
        self._found: list[Attractor] = []
        self._found_at = ""
        self.status = "none"
        self.actions: dict[str, Callable[[dict[str, Any]], None]] = {
            "map-visible": self._look, "map-stop": lambda _: self._cancel(), "map-compute": lambda _: self._begin(),
            "map-choose": self._choose, "map-attractors": lambda _: self._find(), "map-load": self._load,
        }

    def close(self) -> None:
        """The visitor left."""
        self._visible = False
        self._stop[0] = self._search[0] = 1

    def moved(self) -> None:
        """A knob has moved: another knob than f and A0 makes another diagram, any makes other attractors."""
        if not self._visible:
            return
        self._tell_now()
        if self._found and self._found_at != self._page.session.scene.digest:
            self._forget_attractors()
        if self._stale():
            self._stop[0] = 1
            self._tell(type="map-stale")
            self._due += 1
            self._page.after(_QUIET, self._begin_if_last, self._due)

    def _stale(self) -> bool:
        return self._grid is None or self._grid.digest != page_grid(self._page.session.scene).digest

    def _look(self, message: dict[str, Any]) -> None:
        self._visible = bool(message.get("value"))
        if not self._visible:
            self._cancel()
            return
        if self._grid is not None and not self._stale():
            self._send_all()
            if self.status == "cancelled":
                self._begin()
        else:
            self._begin()
        self._tell_now()
        self._show_attractors("" if self._found else "none")

    def _begin_if_last(self, due: int) -> None:
        if due == self._due and self._visible:
            self._begin()

    def _begin(self) -> None:
        """Compute what is missing of the present diagram, or a new one."""
        self._stop[0] = 1
        self._stop = stop = new_stop()
        if self._grid is None or self._stale():
            self._grid = page_grid(self._page.session.scene)
            self._cells = empty_cells(self._grid)
        self._send_all()
        self._say("waiting")
        in_thread(self._work, self._grid, self._missing(), stop)

    def _missing(self) -> list[int]:
        return [int(number) for number in np.flatnonzero(self._cells["regime"] < 0)]

    def _cancel(self) -> None:
        self._stop[0] = 1
        if self.status in ("waiting", "compiling", "computing"):
            self._say("cancelled")

    def _work(self, grid: Grid, missing: list[int], stop: Stop) -> None:
        """In a thread of its own; a moving knob holds it up."""
        try:
            if not self._compiled(grid.scene, (LIVE, CERTIFIED, CURVE), stop, self._say):
                return
            self._later(stop, self._say, "computing")
            for rows in _batches(grid, missing, stop, partial(self._pause, stop)):
                self._later(stop, self._show, rows)
            self._later(stop, self._say, "done")
        except (BadInput, NumbersFailed) as problem:
            self._later(stop, self._say, "failed", str(problem))
        except Cancelled:
            return
        except Exception as error:
            self._later(stop, self._say, "failed", "The diagram stopped by a fault inside granchain.")
            self._page.later(self._page.failed, error)

    def _pause(self, stop: Stop) -> None:
        while (self._page.unsettled or self._page.curves.computing) and not stop[0]:
            time.sleep(_PATIENCE)

    # To the browser

    def _tell(self, **message: Any) -> None:
        self._page.views.corner.tell(**message)

    def _tell_now(self) -> None:
        scene = self._page.session.scene
        self._tell(type="map-now", x=scene.f, y=scene.A0)

    def _say(self, status: str, sentence: str = "") -> None:
        self.status = status
        self._tell(type="map-status", status=status, sentence=sentence)

    def _send_all(self) -> None:
        assert self._grid is not None
        self._tell(**head_message(self._grid))
        self._show(self._cells[self._cells["regime"] >= 0])

    def _show(self, rows: np.ndarray) -> None:
        assert self._grid is not None
        self._cells[rows["number"]] = rows
        done = float((self._cells["regime"] >= 0).mean())
        with unlocked():
            self._tell(**cells_message(self._grid, rows, done))

    def _choose(self, message: dict[str, Any]) -> None:
        """A place of the diagram was clicked: f and A0 go there."""
        self._page.session.change("f", message.get("x"))
        self._page.received({"do": "set", "name": "A0", "value": message.get("y")})

    # Attractors

    def _find(self) -> None:
        self._search[0] = 1
        self._search = stop = new_stop()
        self._found = []
        self._show_attractors("searching")
        in_thread(self._search_work, self._page.session.scene, stop)

    def _search_work(self, scene: Scene, stop: Stop) -> None:
        try:
            pieces = (LIVE, CERTIFIED, CURVE) if scene.cuts_tension else (LIVE, CERTIFIED, CURVE, ORBIT_PIECE)
            if self._compiled(scene, pieces, stop, self._show_attractors):
                self._later(stop, self._show_attractors, "searching")
                found = attractors(scene, _FEW if scene.cuts_tension else _RANDOM_STATES, stop=lambda: bool(stop[0]))
                shown = [described(one) for one in found]
                self._later(stop, self._arrived, scene, found, shown)
        except (BadInput, NumbersFailed) as problem:
            self._later(stop, self._show_attractors, "failed", str(problem))
        except Exception as error:
            self._later(stop, self._show_attractors, "failed", "The search stopped by a fault inside granchain.")
            self._page.later(self._page.failed, error)

    def _arrived(self, scene: Scene, found: list[Attractor], shown: list[dict[str, Any]]) -> None:
        self._found, self._found_at, self._shown = found, scene.digest, shown
        self._show_attractors("")

    def _show_attractors(self, status: str, sentence: str = "") -> None:
        shown = self._shown if self._found else []
        self._tell(type="map-attractors", status=status, sentence=sentence, attractors=shown)

    def _forget_attractors(self) -> None:
        self._search[0] = 1
        self._found = []
        self._show_attractors("none")

    def _load(self, message: dict[str, Any]) -> None:
        """Put the chain on one of the attractors; from there knobs move it along."""
        number = message.get("number")
        if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < len(self._found):
            raise BadInput("That attractor is not in the list any more; look for them again.")
        page = self._page
        page.session.set_mode("settled")
        page.session.set_start("previous")
        page.live = None
        page.header()
        page.jobs.submit(partial(_from_attractor, self._found[number]))


def _from_attractor(attractor: Attractor, stop: Stop) -> Iterator[Settled]:
    """Pictures of an attractor, from its own state."""
    yield from settling(attractor.scene, start=attractor.state, samples=samples_for(attractor.scene), stop=stop)


def _batches(grid: Grid, missing: list[int], stop: Stop, pause: Callable[[], None]) -> Iterator[np.ndarray]:
    """Cells as they come, a lot at a time."""
    rows: list[np.ndarray] = []
    last = time.monotonic()
    for result in iter_diagram(grid, missing, lambda: bool(stop[0]), 1, pause):
        rows.append(cell_of(result))
        if time.monotonic() - last > _BATCH:
            yield np.array(rows)
            rows, last = [], time.monotonic()
    if rows:
        yield np.array(rows)
