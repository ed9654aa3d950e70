"""The keys that scripts react to are in the help."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

APP = Path(__file__).parents[2] / "app"
#: The scripts that react to keys, and what the help calls the place of their keys; empty if they work everywhere.
PLACES = {
    "dashboard/tabs.js": "on tabs", "pages/map/map.js": "on the parameter map",
    "pages/stability/multiplier_plane.js": "on the multipliers", "parts/header/header.js": "", "parts/header/keys.js": "",
    "parts/header/tour.js": "", "parts/inline_scripts/shared.js": "", "parts/knobs/knob.js": "on a knob",
    "parts/time/crosshair.js": "", "parts/time/cursor.js": "on the time cursor", "parts/toolkit/bubble.js": "",
}
#: Every key by its name in scripts, and its word in the help.
WORDS = {"ArrowUp": "↑", "ArrowDown": "↓", "ArrowLeft": "←", "ArrowRight": "→", "PageUp": "Page ↑", "PageDown": "Page ↑ and ↓",
         "Home": "Home", "End": "End", "Delete": "Delete", "Backspace": "Backspace", "Enter": "Enter", "Escape": "Esc",
         " ": "Space", "?": "?", "z": "Ctrl-Z", "y": "Ctrl-Y"}
#: A key in a script: the key of a table, or a text that is compared with the event's key.
KEY = re.compile(r'\b([A-Z]\w+): ?[-\w[]|\bkey [!=]== "([^"]+)"')


def script(name: str) -> str:
    """Return the text of a script."""
    return (APP / name).read_text(encoding="utf-8")


def rows_of_the_help() -> list[str]:
    """Return the rows of the table of keys, each as one text."""
    table = script("parts/header/popovers.js").partition("const KEYS = [")[2].partition("\n];")[0]
    return [" ".join(texts) for texts in re.findall(r'\[\s*"([^"]*)",\s*"([^"]*)",?\s*\]', table)]


def test_the_table_has_every_script_with_keys() -> None:
    """A new script with keys is a row of `PLACES`, and its keys are in the help."""
    with_keys = {str(path.relative_to(APP)) for path in APP.rglob("*.js") if re.search(r"keydown|keyup|keypress|event\.key\b",
                                                                                       path.read_text(encoding="utf-8"))}
    assert with_keys == set(PLACES)


@pytest.mark.parametrize("name", PLACES)
def test_the_help_lists_every_key_of_a_script_with_its_place(name: str) -> None:
    keys = {key for match in KEY.findall(script(name)) for key in match if key in WORDS}
    assert keys or name == "parts/header/header.js", "keys.js has its keys"
    rows = rows_of_the_help()
    assert len(rows) >= 9
    missing = [key for key in sorted(keys) if not any(WORDS[key] in row and PLACES[name] in row for row in rows)]
    assert not missing


def test_scripts_use_no_key_without_a_word() -> None:
    """A script that compares another key would otherwise pass unseen."""
    compared = {key for name in PLACES for key in re.findall(r'\bkey [!=]== "([^"]+)"', script(name))}
    arrows = {key for name in PLACES for key in re.findall(r"\b((?:Arrow|Page)\w+|Home|End|Delete|Insert|F\d+)\b: ", script(name))}
    assert compared | arrows <= set(WORDS)
