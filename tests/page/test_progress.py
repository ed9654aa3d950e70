"""Where a computation stands is said in the same words on every page."""

from __future__ import annotations

import pytest

from app.page.progress import RUNNING, progress


@pytest.mark.parametrize("page", ["accuracy", "branches", "map", "attractors", "observer", "stability"])
def test_who_waits_for_a_compiler_is_told_for_how_long(page: str) -> None:
    told = progress(page, "compiling")
    assert told["running"] and told["progress"].startswith("compiling the ")
    assert told["progress"].endswith(" s, only the first time on this computer …")


def test_what_is_over_has_nothing_to_say_unless_it_was_stopped() -> None:
    for status in ("none", "done", "failed"):
        assert progress("accuracy", status) == {"status": status, "progress": "", "running": False}
    assert progress("branches", "cancelled") == {"status": "cancelled", "progress": "stopped; the orbits found so far are kept", "running": False}
    assert progress("hard", "cancelled")["progress"] == "cancelled"


def test_what_is_under_way_is_running_on_every_page() -> None:
    for status in set(RUNNING) - {"compiling"}:
        assert progress("hard", status)["running"]
    assert progress("map", "waiting")["progress"] != progress("hard", "waiting")["progress"] == "waiting for its turn …"
