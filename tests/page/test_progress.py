"""Where a computation stands is said in the same words on every page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.page import progress as module
from app.page.progress import UNDER_WAY, progress

PAGES = Path(module.__file__).parents[1] / "pages"
#: What is over, or was not begun.
STILL = {"none", "done", "stopped", "failed"}


@pytest.mark.parametrize("page", ["accuracy", "branches", "map", "attractors", "observer", "stability"])
def test_who_waits_for_a_compiler_is_told_for_how_long(page: str) -> None:
    told = progress(page, "compiling")
    assert told["running"] and told["progress"].startswith("compiling the ")
    assert told["progress"].endswith(" s, only the first time on this computer …")


def test_what_is_over_has_nothing_to_say_unless_it_was_stopped() -> None:
    for status in ("none", "done", "failed"):
        assert progress("accuracy", status) == {"status": status, "progress": "", "running": False}
    assert progress("branches", "stopped") == {"status": "stopped", "progress": "stopped; the orbits found so far are kept", "running": False}
    assert progress("hard", "stopped")["progress"] == "stopped"


def test_what_is_under_way_is_running_on_every_page() -> None:
    for status in set(UNDER_WAY) - {"compiling"}:
        assert progress("hard", status)["running"]
    assert progress("map", "waiting")["progress"] != progress("hard", "waiting")["progress"] == "waiting for its turn …"


def test_every_state_that_a_page_names_is_in_the_vocabulary() -> None:
    call = r'(?:(?:_say|_show_attractors)\(|job\.say\(|progress\("\w+", )"(\w+)"'
    named = {state for path in PAGES.rglob("page.py") for state in re.findall(call, path.read_text(encoding="utf-8"))}
    assert len(named) > 8
    assert named <= {*UNDER_WAY, *STILL}


def test_every_page_stops_with_the_same_word() -> None:
    scripts = "".join(path.read_text(encoding="utf-8") for path in PAGES.rglob("*.js"))
    assert len(re.findall(r'button\("stop"', scripts)) == 4
    assert '"cancel"' not in scripts
