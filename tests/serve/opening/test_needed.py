"""What is used of libraries beyond their documentation: the installed releases have it, and a lack is noticed."""

from __future__ import annotations

import logging
import subprocess
import sys

import pytest
from missing_attribute import lose

from app import needed, server
from app.needed import MissingPart, Needed, missing
from app.serve.http import guard

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


REQUIRED = [(row, name) for row in ROWS if row.required for name in row.names]


@pytest.mark.parametrize(("row", "name"), REQUIRED, ids=lambda one: getattr(one, "owner", one))
def test_the_server_does_not_start_without_what_is_required(row: Needed, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    lose(monkeypatch, row.owner, name)
    reached: list[str] = []
    with pytest.raises(MissingPart) as refusal:
        server.serve(before=lambda: reached.append("listening"))
    assert str(refusal.value).startswith(f"This release of {row.owner.split('.')[0].capitalize()} has no {row.owner}.{name}; "
                                         f"granchain does not start without it ({row.without}).")
    assert reached == []


def test_all_rows_of_the_guard_are_required() -> None:
    """The promises of docs/security.md rest on them."""
    assert all(row.required for row in guard.NEEDED)


@pytest.mark.parametrize("row", [row for row in ROWS if not row.required], ids=lambda row: row.owner)
def test_the_log_says_at_the_start_what_else_is_missing_and_what_happens_without_it(
        row: Needed, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(needed, "tables", lambda: {"": (row,)})
    with caplog.at_level(logging.WARNING, "granchain"):
        needed.check_releases()
        assert caplog.messages == []
        lose(monkeypatch, row.owner, row.names[-1])
        needed.check_releases()
    assert caplog.messages == [f"a library has no {row.owner}.{row.names[-1]}: {row.without}"]


@pytest.mark.parametrize(("module", "name"), [
    ("bokeh.server.views.ws", "WSHandler"), ("bokeh.core.property.validation", "validate")])
def test_a_library_that_lacks_an_imported_name_is_one_sentence_of_the_command(module: str, name: str) -> None:
    program = (f"import sys, panel, {module} as module; del module.{name}; from app.cli.commands import do; "
               "sys.exit(do(['serve', '--port', '0']))")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 2
    assert f"This release of Bokeh has no {module}.{name}; granchain does not start without it" in done.stderr
    assert "Traceback" not in done.stderr
