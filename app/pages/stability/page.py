"""The Stability page of one session: when it computes, and whether its result is still valid."""

from __future__ import annotations

from functools import partial
from typing import Any

from granchain_core import BadInput, Scene, Settled, State
from granchain_core.orbits.stroboscopic_map import refuse_cut
from granchain_core.precompile.pieces import ORBIT_KERNELS
from granchain_core.steady.poincare import Section
from granchain_core.steady.regime_criteria import LONGEST_LOCKED_PERIOD

from ...plots.multipliers import plane_state
from ...serve.computing.worker_pools import ANALYSES
from ...session.activities import Activity
from ...session.debounce import Debounce
from ...session.host import PageHost
from ...session.message_checks import check_bool, check_integer
from ...session.page import Actions, Page
from ...session.progress import OFF, Status, StatusWords, activity_state, is_under_way
from ...session.task import Job, Task
from .trail import Trail
from .view import (
    Stability,
    evidence,
    mode_message,
    multiplier_sentence,
    no_multipliers,
    section_points,
    verdict,
)
from .work import PHASES, OrbitAnalysis, OrbitTarget, analyse, search, section_of, transient

#: Time from a settled picture to its analysis [s]: nothing is analysed while a knob moves.
_QUIET = 0.12

_LIVE = "Only a motion that repeats has multipliers, and a live run is under way: choose “settled” above."

WORDS = StatusWords("the tangent flow", ORBIT_KERNELS)

#: Details of a computation that is under way, for the list of computations.
_DETAILS: dict[Status, str] = {
    "compiling": "compiling the tangent flow", "computing": "multipliers, mode and section",
    "searching": "Newton's method for an unstable orbit",
}


class StabilityPage(Page):
    """The page, which analyses every picture that stays while it is visible; a moving knob cancels the analysis."""

    def __init__(self, host: PageHost, view: Stability) -> None:
        self._host = host
        self._view = view
        self._orbits = Task(host, ANALYSES, self._ended, "The analysis")
        self._sections = Task(host, ANALYSES, self._section_ended, "The section")
        self._quiet = Debounce(host, _QUIET)
        self._visible = False
        self._observer = False
        self._rank, self._bead, self._phase = 0, 1, 0
        self._settled: Settled | None = None
        self._start: State | None = None
        self._analysed: State | None = None
        self._target: OrbitTarget | None = None
        self._analysis: OrbitAnalysis | None = None
        self._section: Section | None = None
        self._trail = Trail()
        self.status: Status = "none"
        self.actions: Actions = {
            "stability-observer": self._choose_observer, "stability-mode": self._choose_mode,
            "stability-section": self._choose_section, "stability-search": self._search,
            "stability-back": self._back,
        }

    @property
    def activity(self) -> Activity:
        """Name, state and detail for the list of running computations."""
        if not self._visible:
            return "stability", OFF, "not on the screen"
        state = activity_state(is_under_way(self.status), self._analysed is not None)
        return "stability", state, _DETAILS.get(self.status, "follows the settled picture")

    # The picture in front

    def picture_requested(self) -> None:
        """Cancel the analysis and grey out the last result, because another picture is being computed."""
        self._give_up()
        self._settled = None
        if self._visible and self._host.session.mode == "live":
            self._clear(_LIVE)
        elif self._visible:
            self._view.update_state(stale=True)

    def picture_ready(self, settled: Settled) -> None:
        """Analyse a picture that has arrived, if it is the final one for these knobs and stays on the screen."""
        if not settled.final:
            return
        # whether it is the same picture, now with its energy account
        again = self._settled is not None and settled.state is self._settled.state
        self._settled = settled
        if not again:
            self._start, self._rank = self._host.session.initial_state, 0
            self._quiet.start(self._begin)

    def visibility_changed(self, visible: bool) -> None:
        """Analyse the picture when the page becomes visible; cancel the analysis when it is hidden."""
        self._visible = visible
        if not visible:
            self._give_up()
        elif self._host.session.mode == "live":
            self._clear(_LIVE)
        else:
            self._begin()

    def _give_up(self) -> None:
        self._orbits.cancel()
        self._sections.cancel()
        self._quiet.cancel()
        self._analysed = None
        self.status = "none"

    def _begin(self) -> None:
        """Analyse the picture, unless there is none, it has been analysed, or the page is hidden."""
        settled = self._settled
        if not self._visible or settled is None or self._analysed is settled.state:
            return
        self._analysed, self._analysis, self._section = settled.state, None, None
        self._bead = min(self._bead, settled.run.scene.N)
        self._view.update_state(stale=True, beads=settled.run.scene.N)
        if settled.regime.name == "periodic" and settled.regime.period is not None:
            self._follow(OrbitTarget(settled.run.scene, settled.regime.period, settled.state, followed=True))
        else:
            self._target = None
            self._clear(no_multipliers(settled))
        self._sections.start(partial(self._make_section, settled, self._start))

    def _follow(self, target: OrbitTarget) -> None:
        self._target = target
        self._show_status("computing")
        self._orbits.start(partial(self._analyse, target, self._observer, self._rank))

    # In a worker thread

    def _analyse(self, target: OrbitTarget, observer: bool, rank: int, job: Job) -> None:
        self._compile(target.scene, job)
        job.next_tick(self._arrived, analyse(target, observer, rank, job.stop))

    def _make_section(self, settled: Settled, start: State | None, job: Job) -> None:
        for section in section_of(settled, start, job.stop):
            job.next_tick(self._arrived, section)

    def _find(self, settled: Settled, section: Section | None, period: int, job: Job) -> None:
        self._compile(settled.run.scene, job)
        job.next_tick(self._arrived, search(settled, section, period, job.stop))

    @staticmethod
    def _compile(scene: Scene, job: Job) -> None:
        refuse_cut(scene)  # before anything is compiled for the scene
        job.compile(scene, ORBIT_KERNELS)

    # Results

    def _arrived(self, result: OrbitAnalysis | OrbitTarget | Section) -> None:
        if self._settled is None:
            return
        if isinstance(result, OrbitAnalysis):
            self._show(result)
        elif isinstance(result, OrbitTarget):
            self._rank = 0
            self._follow(result)
        else:
            self._section = result
            self._show_section()
        self._show_evidence()

    def _ended(self, status: Status, sentence: str) -> None:
        """Report a failure or a state such as "compiling"; results have already arrived separately."""
        if status != "done":
            self._show_status(status, sentence)
            self._show_evidence()

    def _section_ended(self, status: Status, sentence: str) -> None:
        """Report a failure of the section, which does not affect the analysis."""
        if status == "failed":
            self._view.update_state(failure=sentence)

    def _show(self, analysis: OrbitAnalysis) -> None:
        self._analysis, self.status = analysis, "done"
        orbit = analysis.orbit
        if analysis.target.followed:
            self._trail.follow(orbit.multipliers, orbit.period, orbit.scene.name)
        before = self._trail.before(orbit.period) if analysis.target.followed else []
        self._view.need_figures()
        self._view.update_state(
            **WORDS.of("done"), stale=False, sentence=verdict(orbit), observer=self._observer,
            searched=not analysis.target.followed, rank=self._rank, period=orbit.period,
            count=len(orbit.multipliers), chosen=multiplier_sentence(orbit, self._rank),
            plane=plane_state(orbit, self._observer, self._rank, before))
        self._view.send(**mode_message(analysis.mode, orbit))
        self._show_section()

    def _show_section(self) -> None:
        if self._section is None or self._settled is None:
            return
        own = None if self._analysis is None else self._analysis.points
        regime = self._settled.regime
        self._view.section(section_points(
            self._section, transient(self._settled, self._section), own, self._bead, self._phase,
            regime.period or 1 if regime.name == "periodic" else 0,
            unstable=self._analysis is not None and not self._analysis.target.followed))

    def _show_evidence(self) -> None:
        if self._settled is not None:
            self._view.update_state(evidence=evidence(self._settled, self._analysis, self._section))

    def _clear(self, sentence: str) -> None:
        """Show a sentence with the reason for having no multipliers."""
        self._analysis, self.status = None, "none"
        self._view.update_state(**WORDS.of("none"), stale=False, sentence=sentence,
                                plane=plane_state(None), count=0, chosen="", searched=False, evidence=[],
                                observer=self._observer)
        self._view.send(type="no-mode")
        if self._host.session.mode == "live":
            self._view.send(type="no-section")
        self._show_evidence()

    def _show_status(self, status: Status, sentence: str = "") -> None:
        self.status = status
        self._view.update_state(**WORDS.of(status, sentence))
        if status == "failed" and self._analysis is None and self._target is not None:
            self._view.update_state(sentence=sentence, failure="", plane=plane_state(None), count=0, chosen="",
                                    stale=False)
            self._view.send(type="no-mode")

    # The visitor's actions

    def _choose_observer(self, message: dict[str, Any]) -> None:
        self._observer = check_bool("observer", message.get("value"))
        self._view.update_state(observer=self._observer)
        self._again()

    def _choose_mode(self, message: dict[str, Any]) -> None:
        self._rank = check_integer("mode", message.get("value"), 0, 2 * self._host.session.scene.N - 1)
        self._again()

    def _again(self) -> None:
        """Analyse the same orbit with the visitor's new choices."""
        if self._visible and self._target is not None and self._settled is not None:
            self._follow(self._target)

    def _choose_section(self, message: dict[str, Any]) -> None:
        self._bead = check_integer("bead", message.get("bead"), 1, self._host.session.scene.N)
        self._phase = check_integer("phase", message.get("phase"), 0, PHASES - 1)
        self._show_section()

    def _search(self, message: dict[str, Any]) -> None:
        period = check_integer("period", message.get("value"), 1, LONGEST_LOCKED_PERIOD)
        settled, section = self._settled, self._section
        if not self._visible or settled is None:
            raise BadInput("There is no settled picture to search from yet; wait for it.")
        self._show_status("searching")
        self._orbits.start(partial(self._find, settled, section, period))

    def _back(self, _: dict[str, Any]) -> None:
        """Return from a search, or from the orbit it found, to the settled motion."""
        self._give_up()
        self._begin()
