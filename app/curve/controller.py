"""The resonance curves of one dashboard: which are shown, when they are computed, and how they reach the figure."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from granchain_core import CurvePoint, Scene
from granchain_core.experiment import Difference, Measured, stated_features
from granchain_core.precompile.pieces import CURVE_KERNELS
from granchain_core.steady.curve.order import CURVE_STARTS

from ..plots.curve import CURVE_STYLES
from ..serve.compiling.compiler import COMPILER, PICTURE_PIECES, Requests
from ..serve.computing.worker_pools import CURVES
from ..session.activities import Activity
from ..session.budget import curve_affordable
from ..session.debounce import Debounce
from ..session.host import PageHost
from ..session.progress import COMPUTING, OFF, READY, ActivityState
from ..session.scene_facts import rig_beads, slider_range, without_frequency
from ..session.share import joined
from ..session.task import Task
from .computation import CurveComputation, Progress
from .curve_bar import CHOICES, CurveBar, shown_progress
from .drafts import Drafts
from .peak_names import PeakNames, stated_name
from .reports import Reports
from .request import CurveRequest
from .view import CurveFigure

#: Time for which the knobs must rest before a curve starts [s]: nobody reads a curve while dragging.
CURVE_QUIET = 0.35


class CurveController:
    """Computes the selected curves while they are on screen, each only once for the same knobs.

    `placed` shows where on the curve from rest the present motion lies. It is called when such a curve is complete, and
    when an expected curve will not be computed.
    """

    def __init__(self, host: PageHost, figure: CurveFigure, bar: CurveBar, placed: Callable[[], None]) -> None:
        self._host = host
        self._figure = figure
        self._bar = bar
        self._placed = placed
        self._compared: list[Callable[[Difference | None], None]] = []
        self._task = Task(host, CURVES, self._ended, "The resonance curve", report_to_host=True)
        self._drafts = Drafts(host, figure, self._draft_drawn)
        self._quiet = Debounce(host, CURVE_QUIET)
        self._reports = Reports(host, self._draw)
        self._visible = True
        #: Whether each curve, by its start, and the stated features are selected.
        self._wanted = {name: name == "rest" for name, *_ in CHOICES}
        #: Scenes from `without_frequency`, since a curve is the same at every f: for the present knobs, and for the
        #: complete curve from each start.
        self._wanted_for: Scene | None = None
        self._complete_for: dict[str, Scene] = {}
        #: The curves that were started last.
        self._request = CurveRequest()
        #: The error that kept the kernels of the present knobs from being compiled.
        self._uncompiled: Exception | None = None
        self._kernels = Requests(COMPILER)
        self._names = PeakNames(host, self._show_names)

    def selection(self, scene: Scene) -> str:
        """Return the selected curves as links name them; "auto" for the scene's default selection."""
        chosen = {name for name, wanted in self._wanted.items() if wanted}
        return "auto" if chosen == _own(scene) else joined(chosen)

    def show_preset(self, scene: Scene, selected: str) -> str:
        """Show an empty figure over another scene's frequencies, and select the curves of a link; return the selection.

        If `selected` is empty, the same curves stay selected, and the paper's rig shows its stated features.
        """
        self._complete_for.clear()
        self._names.forget()
        self._drafts.drop()
        self._figure.clear()
        self._figure.set_range(*slider_range(scene, "f"))
        if selected:
            return self.select(scene, selected)
        self._wanted["features"] = scene.pattern == rig_beads()
        self._show_features(scene)
        self.restart_when_quiet(scene)
        return self.selection(scene)

    def knob_moved(self, scene: Scene) -> None:
        """React to a moved knob: for any knob except f, draw a draft at once, and the curve when the knobs rest."""
        if without_frequency(scene) == self._wanted_for:
            return
        self._names.forget()
        self.restart_when_quiet(scene)
        if self._visible and self._wanted["rest"] and curve_affordable(scene) and COMPILER.has(scene, CURVE_KERNELS):
            self._drafts.submit(scene)

    def restart_when_quiet(self, scene: Scene) -> None:
        """Cancel the curve and start again when the knobs rest, because the scene or the selection has changed."""
        self._cancel()
        self._wanted_for = without_frequency(scene)
        self._figure.expected = self._visible and self._wanted["rest"] and curve_affordable(scene)
        self._bar.update_state(driven=scene.is_driven, too_long=scene.is_driven and not curve_affordable(scene))
        self._quiet.start(self._begin_when_compiled, scene)

    def _cancel(self) -> None:
        """Cancel the curve, and drop reports not drawn yet: drawing them would show a curve under way."""
        self._task.cancel()
        self._reports.drop()

    def _begin_when_compiled(self, scene: Scene) -> None:
        if not curve_affordable(scene):
            self._give_up()
            return
        missing = [piece for piece in PICTURE_PIECES if not COMPILER.has(scene, piece)]
        failure = self._kernels.failure(scene, *missing)
        if failure is not None:
            self._say_not_compiled(failure)
        elif missing:
            self._quiet.start(self._begin_when_compiled, scene)  # look again
        else:
            self._uncompiled = None
            self._begin(scene)

    def _say_not_compiled(self, failure: Exception) -> None:
        """Show no new curve, and give the reason once for each failure."""
        self.stop()
        if failure is not self._uncompiled:
            self._uncompiled = failure
            self._host.report_fault(failure, "The resonance curve is not computed: its kernels could not be compiled "
                                             f"({type(failure).__name__}).")

    def _give_up(self) -> None:
        """Show no curve, because the chain has none or it would take too long; another chain's curve would mislead."""
        self.stop()
        self._complete_for.clear()
        self._figure.clear()
        self._placed()

    def visibility_changed(self, visible: bool) -> None:
        """React to the figure coming onto the screen or leaving it."""
        if visible == self._visible:
            return
        self._visible = visible
        if visible:
            self.restart_when_quiet(self._host.session.scene)
        else:
            self.stop()

    def select(self, scene: Scene, selected: str) -> str:
        """Draw the curves that a link names, or for "auto" the scene's default curves; return the selection."""
        chosen = _own(scene) if selected == "auto" else set(selected.split("."))
        self._wanted = {name: name in chosen for name in self._wanted}
        self._show_features(scene)
        self.restart_when_quiet(scene)
        return self.selection(scene)

    def switch(self, name: str, wanted: bool, scene: Scene) -> None:
        """Select or deselect the curve from a start, or the stated features."""
        if name not in self._wanted:
            return
        self._wanted[name] = wanted
        self._bar.update_state(**self._wanted)
        if name == "features":
            self._show_features(scene)
        else:
            self.restart_when_quiet(scene)

    def stop(self) -> None:
        """Stop computing; the points computed so far stay."""
        self._cancel()
        self._drafts.drop()
        self._request.done = None
        self._bar.update_state(done=shown_progress(None))
        if self._figure.expected:
            self._figure.expected = False
            self._placed()

    @property
    def computing(self) -> bool:
        """Whether a curve is under way."""
        return self._request.computing

    def activities(self) -> list[Activity]:
        """Return name, state and detail of the curve from every start at this moment."""
        return [(f"resonance curve, {CURVE_STYLES[name].words}", *self._state(name)) for name in CURVE_STARTS]

    def _state(self, start: str) -> tuple[ActivityState, str]:
        """Return state and detail of the curve from one start."""
        scene, request = self._wanted_for, self._request
        if not self._wanted[start]:
            return OFF, "not selected"
        if request.scene is not None and self._complete_for.get(start) == request.scene:
            return READY, "all points are computed"
        if not self._visible:
            return OFF, "not on the screen"
        if scene is not None and not scene.is_driven:
            return OFF, "nothing drives the chain"
        if scene is not None and not curve_affordable(scene):
            return OFF, "it would take too long; granchain curve computes it"
        if self._uncompiled is not None:
            return OFF, "its kernels could not be compiled"
        if start in request.missing and request.computing:
            return COMPUTING, f"{100 * (request.done or 0.0):.0f} % of the curves asked for"
        return OFF, "waits until the knobs rest, or was stopped"

    def measured(self, measured: Measured | None) -> Difference | None:
        """Draw the visitor's data, or remove them; return their difference from a complete curve from rest."""
        self._figure.measured(measured)
        return self._figure.difference

    def on_compared(self, action: Callable[[Difference | None], None]) -> None:
        """Call `action` with each complete curve's difference from the data; with None when a curve starts."""
        self._compared.append(action)

    def _notify_compared(self, difference: Difference | None) -> None:
        for action in self._compared:
            action(difference)

    def complete(self, scene: Scene) -> dict[str, list[CurvePoint]]:
        """Return the curves of a scene that are drawn and complete, by start."""
        key = without_frequency(scene)
        return {name: self._figure.points(name) for name in CURVE_STARTS
                if self._wanted[name] and self._complete_for.get(name) == key}

    def _begin(self, scene: Scene) -> None:
        """Compute the selected curves that are missing; a change of f alone needs no new curve."""
        key = without_frequency(scene)
        missing = [name for name in CURVE_STARTS
                   if self._visible and self._wanted[name] and self._complete_for.get(name) != key]
        for name in missing:
            self._complete_for.pop(name, None)
        self._request = CurveRequest.of(key, missing)
        shown = [name for name in CURVE_STARTS if self._wanted[name]]
        self._figure.show_only(shown)
        self._figure.begin(missing)
        self._bar.update_state(**self._wanted, done=shown_progress(self._request.done))
        if "rest" in missing:
            self._notify_compared(None)
        self._drafts.drop()
        if missing:
            self._task.start(CurveComputation(scene, missing, self._reports.add, lambda: self._host.busy))
        else:
            self._task.cancel()

    def _draft_drawn(self) -> None:
        """Compute the curve from rest again even for the same knobs, because a draft has replaced it."""
        self._complete_for.pop("rest", None)

    def _show_features(self, scene: Scene) -> None:
        stated = stated_features() if self._wanted["features"] else ()
        self._figure.features(stated)
        self._bar.update_state(**self._wanted, rig=scene.pattern == rig_beads(),
                               stated=[stated_name(feature) for feature in stated])

    def _draw(self, reports: list[Progress]) -> None:
        """Draw the points of these reports, and note which curves they complete."""
        points: dict[str, list[CurvePoint]] = {}
        for progress in reports:
            points.setdefault(progress.start, []).extend(progress.points)
        covering = {progress.start for progress in reports if progress.covers_range}
        for start, new in points.items():
            self._figure.add(start, new, start in covering)
        for progress in reports:
            if progress.complete:
                self._completed(progress.start)
        self._request.advance(reports[-1])
        self._bar.update_state(done=shown_progress(self._request.done))

    def _completed(self, start: str) -> None:
        """Note that the curve from a start is complete, and use it."""
        scene = self._request.scene
        if scene is None:
            return
        self._complete_for[start] = scene
        self._figure.note_complete(start)
        self._placed()
        if start == "rest":
            self._names.name(self._figure.points("rest"), scene)
        self._notify_compared(self._figure.difference)

    def _show_names(self, names: list[dict[str, Any]]) -> None:
        """Show the names of peaks, valleys and stop band, with their heights on the axis."""
        factor = self._figure.factor
        self._bar.update_state(names=[{**name, "height": name["force"] / factor} for name in names])

    def _ended(self, status: str, _: str) -> None:
        if status == "failed":
            self.stop()


def _own(scene: Scene) -> set[str]:
    """Return the curves that a scene shows by default; the paper's rig also has stated features."""
    return {"rest", "features"} if scene.pattern == rig_beads() else {"rest"}
