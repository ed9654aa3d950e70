"""Commands in console blocks of README and docs print the output that is shown there."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest
from documents import PAGES, blocks

from app import cli

#: The last digits of stated errors, and of counts of steps and events, depend on the processor's order of rounding.
_NEARLY = 0.05
_TIME = re.compile(r"\d[\d.]* (?:ms|s)$", re.MULTILINE)


def shown() -> list[tuple[str, list[str]]]:
    """Return every command whose output a page shows, and the lines of that output."""
    found = []
    for page in PAGES:
        for block in blocks(page):
            commands = re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:] if block.language == "console" else []
            lines = [command.splitlines() for command in commands]
            found += [(line, output) for line, *output in lines if output and line.startswith("granchain ")]
    return found


def alike(shown: str, printed: str) -> bool:
    """Return whether two words are equal, or are errors or counts that differ only in their last digit."""
    shown, printed = shown.rstrip(",;:)"), printed.rstrip(",;:)")
    if not re.fullmatch(r"\d\.\de-\d\d|\d{4,}", shown):
        return shown == printed
    return float(printed) == pytest.approx(float(shown), rel=_NEARLY, abs=0.11 * 10.0 ** int(shown.partition("e")[2] or 0))


@pytest.mark.parametrize(("command", "lines"), shown(), ids=[command for command, _ in shown()])
def test_a_command_prints_what_its_page_shows(command: str, lines: list[str], tmp_path: Path,
                                              monkeypatch: pytest.MonkeyPatch) -> None:
    """The output, on either stream, agrees word by word except for times."""
    monkeypatch.chdir(tmp_path)
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        cli.main(shlex.split(command)[1:])
    printed = said.getvalue().splitlines()
    assert len(printed) == len(lines), printed
    for expected, line in zip(lines, printed, strict=True):
        ours, theirs = _TIME.sub("…", expected).split(), _TIME.sub("…", line).split()
        assert len(ours) == len(theirs) and all(map(alike, ours, theirs)), line


def test_pages_have_at_least_four_console_blocks() -> None:
    assert len(shown()) >= 4
