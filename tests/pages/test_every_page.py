"""Rules for every page of the table, including new ones: when work starts, when it ends, and what is reported.

Each test plays the role of the dashboard, and calls the hooks and actions of the real page; only the work itself is
left out. The other files of this folder test the individual pages.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from inspect import signature
from typing import Any

import pytest
from page_host import FakePageHost, PageUnderTest, picture

from app.dashboard.table import PAGES, PageSpec
from app.pages.analysis.questions import QUESTIONS
from app.pages.stories.page import story_places, story_step
from app.plots.theme import THEMES
from app.serve.computing.worker_pools import LONG
from app.session.host import PageHost
from app.session.page import Page
from app.session.progress import COMPUTING, OFF, READY
from app.session.task import Job, Task
from granchain_core import BadInput
from granchain_core.hard_cases import CASES

OVERLAYS = tuple(row.name for row in PAGES if row.view)


def story_through_others() -> dict[str, Any]:
    """Return the message that opens a step whose motion is reached through others."""
    place = next(place for place in story_places(OVERLAYS) if story_step(place, OVERLAYS).via)
    name, _, step = place.partition(".")
    return {"name": name, "step": int(step)}


#: Requests for the work of pages whose actions need more than their name. Any other page is shown, and each of its
#: actions is requested without a value.
ASKED: dict[str, tuple[tuple[str, dict[str, Any]], ...]] = {
    "analysis": (("analysis-ask", {"question": next(reversed(QUESTIONS))}), ("analysis-compute", {})),
    "hard-cases": (("hard-cases-run", {"case": CASES[0].name}),),
    "stories": (("story-open", story_through_others()),),
}


def has_work(row: PageSpec) -> bool:
    """Return whether the module of a page uses `Task`; the other pages only show results of others."""
    return Task in vars(sys.modules[row.page.__module__]).values()


@pytest.fixture(params=PAGES, ids=lambda row: row.name)
def tested(request: pytest.FixtureRequest, page_of: Callable[[str], PageUnderTest]) -> PageUnderTest:
    """Each page of the table."""
    row: PageSpec = request.param
    return page_of(row.name)


def only(selected: Callable[[PageSpec], bool]) -> pytest.MarkDecorator:
    """Restrict the fixture `tested` to the pages that are selected."""
    return pytest.mark.parametrize("tested", [row for row in PAGES if selected(row)], indirect=True, ids=lambda row: row.name)


with_work = only(has_work)


def asked(tested: PageUnderTest) -> bool:
    """Look at the page and ask for its work; return whether it has any."""
    tested.set_visible()
    tested.deliver_picture()
    for name, message in ASKED.get(tested.row.name, tuple((name, {}) for name in tested.page.actions if not stops(name))):
        try:
            tested.do(name, **message)
        except BadInput:
            assert tested.row.name not in ASKED
    tested.run_callbacks()
    return bool(tested.under_way)


def ask_for_work(tested: PageUnderTest) -> None:
    """Ask a page for its work, which it must start."""
    assert asked(tested), (f"The page {tested.row.name!r} has a task but started no work. If an action needs more than its "
                           "name, add its message to ASKED.")


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


def test_no_work_begins_while_the_page_is_closed(tested: PageUnderTest) -> None:
    hooks(tested.page)
    tested.run_callbacks()
    assert tested.submitted == []


def test_no_work_begins_after_the_page_was_closed(tested: PageUnderTest) -> None:
    tested.set_visible()
    tested.set_visible(False)
    tested.submitted.clear()
    hooks(tested.page)
    tested.run_callbacks()
    assert tested.submitted == []


def test_a_page_opened_before_the_first_picture_does_not_fail(tested: PageUnderTest) -> None:
    tested.host.session.settled = None
    tested.set_visible()
    tested.run_callbacks()
    tested.move_knobs(f=2100.0)
    tested.deliver_picture(picture(2100.0))
    assert tested.host.failures == [] and tested.host.faults == []


@pytest.mark.parametrize("message", [{}, {name: {"none": "of them"} for name in (
    "value", "name", "number", "case", "figure", "bead", "phase", "place", "arm", "period", "question", "values", "step")}],
    ids=["bare", "nonsense"])
def test_a_malformed_message_is_answered_refused_or_ignored(tested: PageUnderTest,
                                                                              message: dict[str, Any]) -> None:
    """A page that does not answer leaves the session as it was."""
    tested.set_visible()
    for name, action in tested.page.actions.items():
        session, before = dict(vars(tested.host.session)), answers(tested)
        try:
            action(message)
        except BadInput as problem:
            assert str(problem).endswith(".")
            assert vars(tested.host.session) == session, f"{name} is refused, but changed the session"
        assert answers(tested) != before or vars(tested.host.session) == session, f"{name} changed the session without a word"


def answers(tested: PageUnderTest) -> Any:
    """Return all that a page has shown, sent, started or asked of the dashboard."""
    return tested.state, list(tested.sent), list(tested.submitted), list(tested.host.shown), tested.host.addresses


@only(lambda row: not has_work(row))
def test_a_page_without_work_begins_none(tested: PageUnderTest) -> None:
    assert not asked(tested), f"The page {tested.row.name!r} starts work; its own module must make the `Task`."


@with_work
def test_the_sentence_of_failed_work_is_shown(tested: PageUnderTest) -> None:
    ask_for_work(tested)

    def fails(_: Job) -> None:
        raise BadInput("The chain is too long for this.")

    tested.compute(fails)
    assert "The chain is too long for this." in tested.sentences and tested.host.faults == []


@with_work
def test_a_fault_is_reported_once_for_each_work_and_said_once(tested: PageUnderTest) -> None:
    ask_for_work(tested)
    begun = len(tested.under_way)

    def fails(_: Job) -> None:
        raise ZeroDivisionError("1/0")

    tested.compute(fails)
    assert len(tested.host.faults) == begun
    said = "an error in granchain (ZeroDivisionError); please report it."
    ends = (said, *(f"{said} (fault {fault})" for fault in tested.host.fault_ids))  # the dashboard adds an id to the first
    assert any(sentence.endswith(ends) for sentence in tested.sentences)
    assert tested.host.failures == []


@with_work
def test_long_work_can_be_stopped_and_the_page_says_so(tested: PageUnderTest) -> None:
    """Short work needs no stop; removing measured data stops the work on them."""
    ask_for_work(tested)
    stopping = tested.under_way
    names = list(filter(stops, tested.page.actions))
    if not names:
        assert tested.row.name == "data" or LONG.name not in [submitted.pool for submitted in tested.submitted]
        return
    for name in names:
        tested.do(name)
    assert all(submitted.job.stop for submitted in stopping)
    assert "stopped" in tested.statuses
    nothing_arrives(tested)


@with_work
def test_a_moved_knob_ends_the_work_or_the_page_calls_it_out_of_date(tested: PageUnderTest) -> None:
    """The exception is a task that states why it continues. The page's next computation is of the new chain."""
    ask_for_work(tested)
    begun = tested.under_way
    tested.move_knobs(f=2100.0)
    assert tested.is_stale or all(submitted.job.stop for submitted in begun if not submitted.task.outlives_knobs)
    if all(submitted.job.stop for submitted in begun):
        nothing_arrives(tested)


def test_work_ends_with_the_session(tested: PageUnderTest) -> None:
    asked(tested)
    tested.host.leave()
    assert tested.under_way == []
    nothing_arrives(tested)


def test_the_line_of_a_page_has_one_of_the_known_states(tested: PageUnderTest) -> None:
    for step in (lambda: None, tested.set_visible, lambda: asked(tested), lambda: tested.move_knobs(f=2100.0), lambda: tested.set_visible(False)):
        step()
        activity = tested.page.activity
        assert activity is None or (activity[0] and activity[1] in (OFF, READY, COMPUTING) and activity[2])


def nothing_arrives(tested: PageUnderTest) -> None:
    """Check that results of work found after it was cancelled are not shown."""
    tested.run_callbacks()
    before = tested.state, len(tested.sent)
    for submitted in tested.submitted:
        if submitted.job.stop:
            submitted.job.next_tick(tested.view.send, type="late")
            submitted.job.report("computing")
    tested.run_callbacks()
    assert (tested.state, len(tested.sent)) == before
