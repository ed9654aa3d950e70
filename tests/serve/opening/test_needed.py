"""What is used of libraries beyond their documentation: the installed releases have it, and a lack is noticed."""

from __future__ import annotations

import logging

import pytest
from missing_attribute import lose

from app import needed
from app.needed import Needed, missing

pytestmark = pytest.mark.quick

ROWS = [row for table in needed.tables().values() for row in table]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.owner)
def test_the_installed_releases_have_what_is_used(row: Needed) -> None:
    """Fails with the name where one has not: docs/libraries.md says what happens then."""
    assert missing([row]) == []


def test_what_is_not_there_is_named() -> None:
    rows = [Needed("bokeh.document.Document", ("callbacks", "no_such_name"), ""), Needed("bokeh.no_such_module", ("it",), ""),
            Needed("bokeh.model.Model.select", ("no_such_keyword",), ""), Needed("bokeh.model", ("Model",), "")]
    assert [name for _, name in missing(rows)] == [
        "bokeh.document.Document.no_such_name", "bokeh.no_such_module.it", "bokeh.model.Model.select.no_such_keyword"]


def test_the_log_says_at_the_start_what_is_missing_and_what_happens_without_it(
        monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "granchain"):
        needed.warn_of_missing()
        assert caplog.messages == []
        lose(monkeypatch, "tornado.web.Application", "wildcard_router")
        needed.warn_of_missing()
    assert caplog.messages == ["a library has no tornado.web.Application.wildcard_router: the server does not start"]
