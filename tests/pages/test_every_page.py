"""Rules for every page of the table, including new ones: when work starts, when it ends, and what is reported.

Each test plays the role of the dashboard, and calls the hooks and actions of the real page; only the work itself is
left out. The other files of this folder test the individual pages.
"""

from __future__ import annotations

from collections.abc import Callable
from inspect import signature
from typing import Any

import pytest
from page_host import FakePageHost, Trial, picture

from app.dashboard.table import PAGES, PageSpec
from app.pages.analysis.questions import QUESTIONS
from app.pages.stories.page import story_places, story_step
from app.plots.theme import THEMES
from app.serve.computing.worker_pools import LONG
from app.session.host import PageHost
from app.session.page import Page
from app.session.progress import COMPUTING, OFF, READY
from app.session.task import Job
from granchain_core import BadInput
from granchain_core.hard_cases import CASES

OVERLAYS = tuple(row.name for row in PAGES if row.view)


def told_by_others() -> dict[str, Any]:
    """Return the message that opens a step whose motion is reached through others."""
    place = next(place for place in story_places(OVERLAYS) if story_step(place, OVERLAYS).via)
    name, _, step = place.partition(".")
    return {"name": name, "step": int(step)}


#: Requests for the work of pages whose actions need more than their name. Any other page is shown, and each of its
#: actions is requested.
ASKED: dict[str, tuple[tuple[str, dict[str, Any]], ...]] = {
    "analysis": (("analysis-ask", {"question": next(reversed(QUESTIONS))}), ("analysis-compute", {})),
    "hard-cases": (("hard-cases-run", {"case": CASES[0].name}),),
    "stories": (("story-open", told_by_others()),),
}
#: Pages that only show results of others.
WITHOUT_WORK = ("numbers", "probe")


@pytest.fixture(params=PAGES, ids=lambda row: row.name)
def trial(request: pytest.FixtureRequest, page_of: Callable[[str], Trial]) -> Trial:
    """Each page of the table."""
    row: PageSpec = request.param
    return page_of(row.name)


def only(names: Callable[[str], bool]) -> pytest.MarkDecorator:
    """Restrict the fixture `trial` to pages whose names are selected."""
    return pytest.mark.parametrize("trial", [row for row in PAGES if names(row.name)], indirect=True, ids=lambda row: row.name)


with_work = only(lambda name: name not in WITHOUT_WORK)


def asked(trial: Trial) -> bool:
    """Look at the page and ask for its work; return whether it has any."""
    trial.look()
    trial.settle()
    for name, message in ASKED.get(trial.row.name, tuple((name, {}) for name in trial.page.actions if not stops(name))):
        try:
            trial.do(name, **message)
        except BadInput:
            assert trial.row.name not in ASKED
    trial.rest()
    return bool(trial.under_way)


def ask_for_work(trial: Trial) -> None:
    """Ask a page for its work, which it must start."""
    assert asked(trial)


def stops(action: str) -> bool:
    """Return whether an action stops the page's work."""
    return action.endswith("-stop")


def hooks(page: Page) -> None:
    """Call all hooks by which the dashboard informs a page, except the one about visibility."""
    page.picture_requested()
    page.scene_changed()
    page.address_applied()
    page.theme_changed(THEMES["dark"])
    page.picture_ready(picture())
    page.curve_ready()
    page.curve_compared(None)


def test_the_host_of_these_tests_is_called_as_the_dashboard_is() -> None:
    for name in (name for name in dir(PageHost) if not name.startswith("_")):
        real, ours = getattr(PageHost, name), getattr(FakePageHost, name)
        assert isinstance(real, property) or list(signature(ours).parameters) == list(signature(real).parameters), name


def test_nothing_begins_while_nobody_looks(trial: Trial) -> None:
    hooks(trial.page)
    trial.rest()
    assert trial.given == []


def test_nothing_begins_after_somebody_has_looked_away(trial: Trial) -> None:
    trial.look()
    trial.look(False)
    trial.given.clear()
    hooks(trial.page)
    trial.rest()
    assert trial.given == []


def test_a_page_is_looked_at_before_there_is_a_picture(trial: Trial) -> None:
    trial.host.session.settled = None
    trial.look()
    trial.rest()
    trial.turn(f=2100.0)
    trial.settle(picture(2100.0))
    assert trial.host.failures == [] and trial.host.faults == []


@pytest.mark.parametrize("message", [{}, {name: {"none": "of them"} for name in (
    "value", "name", "number", "case", "figure", "bead", "phase", "place", "arm", "period", "question", "values", "step")}],
    ids=["bare", "nonsense"])
def test_a_message_without_sense_is_answered_or_refused_in_a_sentence(trial: Trial, message: dict[str, Any]) -> None:
    trial.look()
    for action in trial.page.actions.values():
        try:
            action(message)
        except BadInput as problem:
            assert str(problem).endswith(".")


@only(lambda name: name in WITHOUT_WORK)
def test_a_page_without_work_begins_none(trial: Trial) -> None:
    assert not asked(trial)


@with_work
def test_the_sentence_of_failed_work_is_shown(trial: Trial) -> None:
    ask_for_work(trial)

    def fails(_: Job) -> None:
        raise BadInput("The chain is too long for this.")

    trial.compute(fails)
    assert "The chain is too long for this." in trial.sentences and trial.host.faults == []


@with_work
def test_a_fault_is_reported_once_for_each_work_and_said_once(trial: Trial) -> None:
    ask_for_work(trial)
    begun = len(trial.under_way)

    def fails(_: Job) -> None:
        raise ZeroDivisionError("1/0")

    trial.compute(fails)
    assert len(trial.host.faults) == begun
    said = "an error in granchain (ZeroDivisionError); please report it."
    ends = (said, *(f"{said} (fault {fault})" for fault in trial.host.fault_ids))  # the dashboard adds an id to the first
    assert any(one.endswith(ends) for one in trial.sentences)
    assert trial.host.failures == []


@with_work
def test_long_work_can_be_stopped_and_the_page_says_so(trial: Trial) -> None:
    """Short work needs no stop; removing measured data stops the work on them."""
    ask_for_work(trial)
    stopping = trial.under_way
    names = list(filter(stops, trial.page.actions))
    if not names:
        assert trial.row.name == "data" or LONG.name not in [one.pool for one in trial.given]
        return
    for name in names:
        trial.do(name)
    assert all(one.job.stop for one in stopping)
    assert "stopped" in trial.statuses
    nothing_arrives(trial)


@with_work
def test_a_moved_knob_ends_the_work_or_the_page_calls_it_out_of_date(trial: Trial) -> None:
    """The exception is a task that states why it continues. The page's next computation is of the new chain."""
    ask_for_work(trial)
    begun = trial.under_way
    trial.turn(f=2100.0)
    assert trial.is_stale or all(one.job.stop for one in begun if not one.task.outlives_knobs)
    if all(one.job.stop for one in begun):
        nothing_arrives(trial)


def test_work_ends_with_the_session(trial: Trial) -> None:
    asked(trial)
    trial.host.leave()
    assert trial.under_way == []
    nothing_arrives(trial)


def test_the_line_of_a_page_has_one_of_the_known_states(trial: Trial) -> None:
    for step in (lambda: None, trial.look, lambda: asked(trial), lambda: trial.turn(f=2100.0), lambda: trial.look(False)):
        step()
        line = trial.page.activity
        assert line is None or (line[0] and line[1] in (OFF, READY, COMPUTING) and line[2])


def nothing_arrives(trial: Trial) -> None:
    """Check that results of work found after it was cancelled are not shown."""
    trial.rest()
    before = trial.state, len(trial.told)
    for one in trial.given:
        if one.job.stop:
            one.job.next_tick(trial.view.send, type="late")
            one.job.report("computing")
    trial.rest()
    assert (trial.state, len(trial.told)) == before
