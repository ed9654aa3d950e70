"""A finished visit leaves nothing behind: no page, no computation, no call."""

from __future__ import annotations

import asyncio
import gc
import logging
import time
import weakref
from typing import Any

import pytest
from bokeh.document import Document
from bokeh.io.state import curstate
from bokeh.server.session import ServerSession
from event_loop import run_async
from listening import Listening
from missing_attribute import hide
from waiting import until

from app.dashboard.controller import Controller
from app.dashboard.layout import Views
from app.serve.computing.worker_pools import PICTURES, SESSION_WORK
from app.serve.connection import leaving
from app.serve.monitoring.metrics import METRICS
from app.server import Access
from granchain_core import OverBudget, scene
from granchain_core.runs.budget import refuse_long_picture
from tools.visitors.visitor import Visitor, query_of


def alive(*kinds: type) -> weakref.WeakSet[Any]:
    """Return the live objects of these classes."""
    gc.collect()
    return weakref.WeakSet(one for one in gc.get_objects() if issubclass(type(one), kinds))


async def visit(address: str, query: str = "", moves: int = 2) -> Visitor:
    """Open the page, move a knob and leave."""
    visitor = Visitor(address, query)
    await visitor.open()
    for number in range(moves):
        assert await visitor.move("f", 400.51 + number) is not None
    await visitor.leave()
    return visitor


def test_pages_that_were_left_are_forgotten(caplog: pytest.LogCaptureFixture) -> None:
    """A handler that Panel keeps for each document used to keep every page: 1.5 MB per visit.

    Bokeh's current document may be the last page's, because its event loop ended before the page was closed.
    """
    one = Listening(Access())
    try:
        address = f"http://127.0.0.1:{one.port}"
        before = alive(Controller, Document)
        with caplog.at_level(logging.ERROR):
            for _ in range(3):
                run_async(visit(address))
            until(lambda: not alive(Controller, Document) - before - weakref.WeakSet([curstate().document]),
                  pause=lambda: time.sleep(0.1))  # leftovers of other tests may disappear meanwhile
        assert not [record for record in caplog.records if record.levelno >= logging.ERROR]
    finally:
        one.stop()


def test_a_page_that_could_not_be_made_is_not_counted_as_a_session(monkeypatch: pytest.MonkeyPatch) -> None:
    """It would never be counted as having left."""
    def fails(*_: object) -> None:
        raise ZeroDivisionError

    one, before = Listening(Access()), METRICS.sessions
    try:
        monkeypatch.setattr(Views, "put_into", fails)
        assert 'id="knobs"' not in one.ask()[2]
        assert METRICS.sessions == before
        monkeypatch.undo()
        assert one.connect(one.token()) == 101
        until(lambda: METRICS.sessions == before, pause=lambda: time.sleep(0.05))
    finally:
        one.stop()


@pytest.mark.parametrize("forgotten", [True, False])
def test_a_long_computation_is_refused_first_and_ends_with_the_session(
        forgotten: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """A heavy request, ten thousand beads at 0.1 Hz, is refused, insisted on, and abandoned.

    It also ends if Bokeh cannot be asked to discard the session.
    """
    if not forgotten:
        hide(monkeypatch, leaving, ServerSession, "request_expiration")

    async def insist(address: str) -> str:
        visitor = Visitor(address, query_of(N=10000, f=0.1, A0=1e-4))
        opening = asyncio.create_task(visitor.open(600.0))
        while not any("would take" in said for said in visitor.sentences):
            await asyncio.sleep(0.05)
        assert PICTURES.busy_threads == 0, "nothing is computed before that"
        await visitor.say(do="insist")
        while PICTURES.busy_threads == 0:
            await asyncio.sleep(0.05)
        await visitor.leave()
        opening.cancel()
        return " ".join(visitor.sentences)

    one = Listening(Access())
    try:
        said = run_async(asyncio.wait_for(insist(f"http://127.0.0.1:{one.port}"), 300))
        assert "would take about" in said and "would fit" in said and "insist" in said
        until(lambda: PICTURES.busy_threads == 0 and SESSION_WORK.busy_threads == 0)
    finally:
        one.stop()


def test_the_offered_beads_or_frequency_fit_into_the_budget() -> None:
    chain = scene("sec2").evolve(N=10_000, f=0.5)
    with pytest.raises(OverBudget, match=r"N = (\d+) or f = ([\d.]+) Hz would fit") as refused:
        refuse_long_picture(chain, 6, 384, 5.0)
    words = str(refused.value).split()
    beads, frequency = int(words[words.index("N") + 2]), float(words[words.index("f") + 2])
    refuse_long_picture(chain.evolve(N=beads), 6, 384, 5.0)
    refuse_long_picture(chain.evolve(f=frequency), 6, 384, 5.0)
