"""Undocumented library internals that the dashboard uses: the installed releases have them; a lack is noticed."""

from __future__ import annotations

import logging
import subprocess
import sys

import pytest
from missing_attribute import lose

from app import library_internals, server
from app.library_internals import Internal, missing

pytestmark = pytest.mark.quick

assert server, "its modules have the tables"
ROWS = [row for table in library_internals.tables().values() for row in table]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.owner)
def test_the_installed_releases_have_the_names_that_are_used(row: Internal) -> None:
    """The test fails with the name of a missing one; docs/libraries.md says what happens then."""
    assert missing([row]) == []


def test_missing_names_of_libraries_are_listed() -> None:
    rows = [Internal("bokeh.document.Document", ("callbacks", "no_such_name"), ""), Internal("bokeh.no_such_module", ("it",), ""),
            Internal("bokeh.model.Model.select", ("no_such_keyword",), ""), Internal("bokeh.model", ("Model",), "")]
    assert [name for _, name in missing(rows)] == [
        "bokeh.document.Document.no_such_name", "bokeh.no_such_module.it", "bokeh.model.Model.select.no_such_keyword"]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.owner)
def test_the_log_lists_missing_names_and_their_consequences_at_the_start(
        row: Internal, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(library_internals, "tables", lambda: {"": (row,)})
    with caplog.at_level(logging.WARNING, "granchain"):
        library_internals.check_releases()
        assert caplog.messages == []
        for name in row.names:
            caplog.clear()
            with monkeypatch.context() as without:
                lose(without, row.owner, name)
                library_internals.check_releases()
            assert caplog.messages == [f"a library has no {row.owner}.{name}: {row.without}"]


@pytest.mark.parametrize(("module", "name"), [
    ("bokeh.util.token", "check_token_signature"), ("bokeh.core.properties", "validate")])
def test_a_library_that_lacks_a_documented_name_is_one_sentence_of_the_command(module: str, name: str) -> None:
    assert _refusal(f"import {module} as module; del module.{name}") == (
        f"This release of Bokeh has no {module}.{name}; granchain does not start without it. The releases that work "
        "are in pyproject.toml.\n")


def test_a_server_whose_requests_cannot_be_checked_does_not_start() -> None:
    """A release of Tornado that looks up handlers differently must not serve without guards."""
    assert _refusal("from tornado.web import Application; del Application.get_handler_delegate") == (
        "This release of Tornado has no tornado.web.Application.get_handler_delegate; granchain does not start "
        "without it (requests would be answered without checks). The releases that work are in pyproject.toml.\n")


def _refusal(before: str) -> str:
    """Return the output of `granchain serve`, which ends with status 2, in a process that has modified a library."""
    program = f"import sys, panel; {before}; from app.cli.commands import do; sys.exit(do(['serve', '--port', '0']))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 2
    return done.stderr
