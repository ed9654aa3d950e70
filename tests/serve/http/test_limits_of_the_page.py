"""docs/security.md has the limits of the code, and names the tests of every limit and of every promise."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app import server
from app.curve.computation import CURVES_SHARED
from app.dashboard.picture_work import PICTURES_SHARED
from app.pages.analysis import questions
from app.serve.computing.worker_pools import LONG
from app.serve.http import guarded_socket
from app.serve.http.frame_rate import FRAME_BURST, FRAME_RATE, FRAME_UNIT
from app.serve.http.limits import LARGEST_UPLOAD, MOST_UPLOADED_POINTS
from app.serve.http.message_rules import LARGEST_PLAIN_CONTENT
from app.server import Access
from app.session.budget import FIRST_PICTURE, UNASKED_CURVE, WHOLE_PICTURE
from app.session.initial_state import MOST_BEADS_IN_LINK
from app.session.share import LONGEST_LINK, PINS
from granchain_core.orbits.branch.branch import MOST_POINTS
from granchain_core.scene.quantities import QUANTITIES

TESTS = Path(__file__).parents[2]
PAGE = (TESTS.parent / "docs" / "security.md").read_text(encoding="utf-8")
#: The rows of the table of the server's limits: limit, value, constant and file, tests.
ROWS = re.findall(r"^\| ([^|]+) \| ([^|]+) \| ([^|]+) \| ([^|]+) \|$",
                  PAGE.split("| limit | value | constant and file | tested by |")[1].split("\n\n")[0], re.MULTILINE)
#: The limits of the server: a value, and the names of its tests.
LIMITS = {limit: (value, re.findall(r"`(\w+)`", tests)) for limit, value, _, tests in ROWS}
#: The rows of the table of what visitors may ask for: what, value, constant and file.
ASKED_ROWS = re.findall(r"^\| ([^|]+) \| (\d+) \| ([^|]+) \|$",
                        PAGE.split("| a visitor asks for | at most | constant and file |")[1].split("\n\n")[0], re.MULTILINE)
#: The section of the promises, without and with the table of their tests.
PROMISES, _, PROMISE_TABLE = PAGE.split("## What is promised\n")[1].split("`--max-sessions` is the only limit")[0].partition(
    "| promise | tested by |")
PROMISE_ROWS = re.findall(r"^\| ([^|`]+) \| ([^|]+) \|$", PROMISE_TABLE, re.MULTILINE)


def constants_in(cell: str) -> tuple[str, ...]:
    """Return the names of constants in a cell, by which rows are found: their words may change."""
    return tuple(re.findall(r"`(\w+)`", cell))


def contains(text: str, value: str) -> bool:
    """Return whether a text contains a value that is no part of a longer number."""
    return re.search(rf"(?<![\w.]){re.escape(value)}(?!\w|\.\d)", text) is not None


def test_the_limits_of_the_document_are_those_of_the_code() -> None:
    """Each row of the table contains the values of its constants, so that neither changes without the other."""
    values = {
        ("IDLE_TIME",): [f"{server.IDLE_TIME} s"],
        ("BODY_TIME", "LARGEST_BODY"): [f"{server.BODY_TIME} s", f"{server.LARGEST_BODY // 1000} kB"],
        ("PING_INTERVAL",): [f"{server.PING_INTERVAL} to {2 * server.PING_INTERVAL} s"],
        ("LARGEST_MESSAGE", "LARGEST_UPLOAD", "LARGEST_PLAIN_CONTENT"): [
            f"{server.LARGEST_MESSAGE / 1e6:.1f} MB", f"{LARGEST_UPLOAD / 1e6:g} MB", f"{LARGEST_PLAIN_CONTENT // 1000} kB"],
        ("FRAME_RATE", "FRAME_BURST", "FRAME_UNIT"): [
            f"{FRAME_RATE:g} a second", f"{FRAME_BURST:g} at once", f"{FRAME_UNIT // 1000} kB"],
        ("MOST_UNSENT",): [f"{guarded_socket.MOST_UNSENT // 1_000_000} MB"],
        ("MOST_UNSENT_TOGETHER",): [f"{guarded_socket.MOST_UNSENT_TOGETHER // 1_000_000} MB"],
        ("UNCONNECTED_MS", "Sessions"): [f"{server.UNCONNECTED_MS // 1000} s", "half of the sessions"],
        ("LONGEST_LINK",): [f"{LONGEST_LINK} characters"],
        ("USUAL_SESSIONS",): [f"{Access().max_sessions}"],
        ("LONG",): [f"{LONG.per_owner_limit} ({LONG.purpose})"],
        ("FIRST_PICTURE", "WHOLE_PICTURE"): [f"{FIRST_PICTURE:g} s (estimated)", f"{WHOLE_PICTURE:g} s of processor time"],
        ("UNASKED_CURVE",): [f"{UNASKED_CURVE:g} s (estimated)"],
        ("PICTURES_SHARED", "CURVES_SHARED"): [f"{PICTURES_SHARED.memory / 1e6:g} MB", f"{CURVES_SHARED.memory / 1e6:g} MB"],
    }
    assert {constants_in(where) for _, _, where, _ in ROWS} == set(values)
    for limit, stated, where, _ in ROWS:
        assert [value for value in values[constants_in(where)] if not contains(stated, value)] == [], limit


def test_the_stated_limits_of_pages_are_those_of_the_code() -> None:
    assert {
        "QUANTITIES": QUANTITIES["N"].high, "PINS": len(PINS), "MOST_BEADS_IN_LINK": MOST_BEADS_IN_LINK,
        "MOST_UPLOADED_POINTS": MOST_UPLOADED_POINTS, "MOST_POINTS": MOST_POINTS,
        "MOST_BEADS": questions.MOST_BEADS, "MOST_VALUES": questions.MOST_VALUES, "MOST_STARTS": questions.MOST_STARTS,
        "MOST_PERIODS": questions.MOST_PERIODS, "MOST_STROBES": questions.MOST_STROBES,
    } == {" ".join(constants_in(where)): int(value) for _, value, where in ASKED_ROWS}


@pytest.mark.parametrize("where", [*(row[2] for row in ROWS), *(row[2] for row in ASKED_ROWS)])
def test_the_constant_of_a_limit_is_in_the_file_that_the_document_names(where: str) -> None:
    places = [re.fullmatch(r"((?:`\w+`(?:, | and )?)+) in `([\w/]+\.py)`", place) for place in where.split("; ")
              if place != "set by `--max-sessions`"]
    for place in places:
        assert place is not None, where
        source = (TESTS.parent / place[2]).read_text(encoding="utf-8")
        for name in re.findall(r"`(\w+)`", place[1]):
            assert re.search(rf"^(class )?{name}\b", source, re.MULTILINE), (name, place[2])


@pytest.mark.parametrize(("what", "tests"), [*((limit, tests) for limit, (_, tests) in LIMITS.items()),
                                             *((promise, list(constants_in(tests))) for promise, tests in PROMISE_ROWS)])
def test_every_limit_and_every_promise_names_its_tests(what: str, tests: list[str]) -> None:
    sources = "\n".join(path.read_text(encoding="utf-8") for path in TESTS.rglob("test_*.py"))
    assert tests and all(f"\ndef {test}(" in sources for test in tests), what


def test_the_table_of_tests_has_every_promise() -> None:
    """A promise with parts in the list has a row for each part."""
    promises: list[str] = []
    for outer, inner in re.findall(r"^(?:- \*\*(.+?)\.\*\*|  - \*(.+?):\*)", PROMISES, re.MULTILINE):
        if outer:
            promises.append(outer)
            heading = outer
        else:
            promises = [name for name in promises if name != heading] + [f"{heading}: {inner.lower()}"]
    assert [name for name, _ in PROMISE_ROWS] == promises
