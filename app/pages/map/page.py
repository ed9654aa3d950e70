"""The Map tab of one session: the parameter map over f and A0 while it is visible, and the search for attractors."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from granchain_core import Scene
from granchain_core.attractor_search import Attractor, attractors
from granchain_core.execution.stop import Stop
from granchain_core.parameter_maps import Axis, Grid, iter_parameter_map
from granchain_core.parameter_maps.cells import cell_of, empty_cells
from granchain_core.precompile.pieces import ORBIT_KERNELS

from ...parts.toolkit.component import Component
from ...plots.parameter_map import mark_row
from ...plots.theme import THEMES, Theme
from ...serve.compiling.compiler import PICTURE_PIECES
from ...serve.computing.worker_pools import LONG
from ...session.debounce import Debounce
from ...session.host import PageHost
from ...session.message_checks import check_index
from ...session.page import Actions, Page
from ...session.progress import Status, StatusWords
from ...session.scene_facts import slider_range
from ...session.task import Job, Task
from .view import cells_message, described_attractor, head_message

#: Time for which the knobs must rest before a new map is started [s].
_QUIET = 0.7
#: Time between two messages while a map grows [s].
_MESSAGE_EVERY = 0.25

#: Cells along f and A0, few enough to be computed in about ten seconds on one core.
COLUMNS = 60
ROWS = 40
#: Number of random states from which attractors are sought.
_RANDOM_STATES = 64
#: Number of random states for a scene that cannot be computed in batches.
_FEW_RANDOM_STATES = 12

WORDS = StatusWords(remaining="the cells computed so far")
SEARCH_WORDS = StatusWords(
    piece=ORBIT_KERNELS, instead={"searching": "searching from rest, from both sweeps and from random states …"})


def page_grid(scene: Scene) -> Grid:
    """Return the grid of a scene's map over the ranges of its sliders; it does not depend on the present f and A0."""
    (f0, f1), (a0, a1) = slider_range(scene, "f"), slider_range(scene, "A0")
    low = scene.evolve(f=f0, A0=a0)
    return Grid(low, Axis.of("f", np.linspace(f0, f1, COLUMNS)), Axis.of("A0", np.geomspace(a0, a1, ROWS).tolist()))


class MapPage(Page):
    """The page, which computes its map while its tab is open."""

    def __init__(self, host: PageHost, view: Component) -> None:
        self._host = host
        self._view = view
        self._visible = False
        self._task = Task(host, LONG, self._show_status, "The map", outlives_knobs="it covers all f and A0")
        self._search = Task(host, LONG, self._show_attractors, "The search")
        self._grid: Grid | None = None
        self._cells: np.ndarray[Any, Any] = np.zeros(0)
        self._shown: list[dict[str, Any]] = []
        self._quiet = Debounce(host, _QUIET)
        self._theme = THEMES["light"]
        self._scale: dict[str, Any] = {}
        self._found: list[Attractor] = []
        #: Digest of the scene whose attractors have been found or are being sought.
        self._searched = ""
        self.status: Status = "none"
        self.actions: Actions = {
            "map-stop": lambda _: self._stop(),
            "map-compute": lambda _: self._begin(), "map-choose": self._choose,
            "map-attractors": lambda _: self._find(), "map-attractors-stop": lambda _: self._stop_search(),
            "map-load": self._load,
        }

    def scene_changed(self) -> None:
        """React to a moved knob: all except f and A0 change the map, and every knob changes the attractors."""
        self._forget_outdated_attractors()
        if not self._visible:
            return
        self._send_mark()
        if self._stale():
            self._cancel()
            self._send(type="map-stale")
            self._quiet.start(self._begin_if_visible)

    def _stale(self) -> bool:
        return self._grid is None or self._grid.digest != page_grid(self._host.session.scene).digest

    def visibility_changed(self, visible: bool) -> None:
        """Show the map, and compute its missing cells, while the page is visible."""
        self._visible = visible
        if not visible:
            self._stop()
            return
        if self._grid is not None and not self._stale():
            self._send_all()
            if self.status == "stopped":
                self._begin()
        else:
            self._begin()
        self._send_mark()
        if not self._search.running:
            self._show_attractors("done" if self._found else "none")

    def theme_changed(self, theme: Theme) -> None:
        """Send the figure again, because its colours are set by the server."""
        changed, self._theme = theme != self._theme, theme
        if changed and self._visible and self._grid is not None:
            self._send_all()

    def _begin_if_visible(self) -> None:
        if self._visible:
            self._begin()

    def _begin(self) -> None:
        """Compute the missing cells of the present map, or a new map."""
        self._task.cancel()
        if self._grid is None or self._stale():
            self._grid = page_grid(self._host.session.scene)
            self._cells = empty_cells(self._grid)
        self._send_all()
        self._show_status("waiting")
        self._task.start(partial(self._work, self._grid, self._missing()))

    def _missing(self) -> list[int]:
        return [int(number) for number in np.flatnonzero(self._cells["regime"] < 0)]

    def _cancel(self) -> bool:
        """Stop computing this map; return whether it was being computed."""
        if not self._task.cancel():
            return False
        self.status = "stopped"
        return True

    def _stop(self) -> None:
        if self._cancel():
            self._show_status("stopped")

    def _work(self, grid: Grid, missing: list[int], job: Job) -> None:
        """In a worker thread, compute the missing cells, waiting while a knob moves."""
        job.compile(grid.scene, *PICTURE_PIECES)
        job.report("computing")
        for rows in _batches(grid, missing, job.stop, partial(job.give_way, self._in_front)):
            job.next_tick(self._show, rows)

    def _in_front(self) -> bool:
        """Return whether a picture or the curve is being computed; the map waits for both."""
        return self._host.awaiting_picture or self._host.curve_computing

    # To the browser

    def _send(self, **message: Any) -> None:
        self._view.send(**message)

    def _send_mark(self) -> None:
        scene = self._host.session.scene
        if self._grid is not None:
            self._send(type="map-mark", mark=mark_row(self._grid, scene.f, scene.A0))

    def _show_status(self, status: Status, sentence: str = "") -> None:
        self.status = status
        self._send(type="map-status", **WORDS.of(status, sentence))

    def _send_all(self) -> None:
        assert self._grid is not None
        self._scale = {}
        self._send(**head_message(self._grid, self._theme))
        self._send_mark()
        self._show(self._cells[self._cells["regime"] >= 0])

    def _show(self, rows: np.ndarray) -> None:
        assert self._grid is not None
        self._cells[rows["number"]] = rows
        message = cells_message(self._grid, rows, self._cells)
        if message["models"] == self._scale:
            message["models"] = {}
        else:
            self._scale = message["models"]
        self._send(**message)

    def _choose(self, message: dict[str, Any]) -> None:
        """Set f and A0 to the values at the clicked place in the map."""
        session = self._host.session
        self._host.turn_knobs(session.scene.evolve(f=message.get("x"), A0=message.get("y")), mode=session.mode)

    # Attractors

    def _find(self) -> None:
        self._search.cancel()
        scene = self._host.session.scene
        self._found, self._searched = [], scene.digest
        self._show_attractors("waiting")
        self._search.start(partial(self._search_work, scene))

    def _stop_search(self) -> None:
        if self._search.cancel():
            self._show_attractors("stopped")

    def _search_work(self, scene: Scene, job: Job) -> None:
        job.compile(scene, *PICTURE_PIECES, *(() if scene.cuts_tension else (ORBIT_KERNELS,)))
        job.report("searching")
        starts = _FEW_RANDOM_STATES if scene.cuts_tension else _RANDOM_STATES
        result = attractors(scene, starts, stop=job.stop)
        job.next_tick(self._arrived, result, [described_attractor(attractor) for attractor in result])

    def _arrived(self, result: list[Attractor], shown: list[dict[str, Any]]) -> None:
        self._found, self._shown = result, shown

    def _show_attractors(self, status: Status, sentence: str = "") -> None:
        shown = self._shown if self._found else []
        self._send(type="map-attractors", **SEARCH_WORDS.of(status, sentence), attractors=shown)

    def _forget_outdated_attractors(self) -> None:
        """Forget the attractors of another scene, and cancel a search for them."""
        if (self._found or self._search.running) and self._searched != self._host.session.scene.digest:
            self._search.cancel()
            self._found = []
            self._show_attractors("none")

    def _load(self, message: dict[str, Any]) -> None:
        """Put the chain on an attractor; from then on, settled pictures start from the previous state."""
        attractor = check_index("attractor", self._found, message.get("number"))
        self._host.session.set_start("previous")
        self._host.turn_knobs(attractor.scene, attractor.state)


def _batches(grid: Grid, missing: list[int], stop: Stop, pause: Callable[[], None]) -> Iterator[np.ndarray]:
    """Yield cells as they are computed, in batches."""
    rows: list[np.ndarray] = []
    last = time.monotonic()
    for result in iter_parameter_map(grid, missing, stop, workers=1, pause=pause):
        rows.append(cell_of(result))
        if time.monotonic() - last > _MESSAGE_EVERY:
            yield np.array(rows)
            rows, last = [], time.monotonic()
    if rows:
        yield np.array(rows)
