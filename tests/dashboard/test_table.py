"""The table of pages: every name is used only once, since messages and links identify pages by it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from urllib.parse import quote

import pytest

from app import former_names
from app.dashboard.table import PAGES, TABS, TabSpec, check_names, tab_names
from app.session import share
from app.session.page_constants import CURVE_NAME


@pytest.mark.parametrize("row", [replace(PAGES[0], name=CURVE_NAME), TabSpec(PAGES[0].name, "learn")], ids=["curve", "twice"])
def test_a_name_that_is_taken_is_refused(row: TabSpec) -> None:
    with pytest.raises(ValueError, match=f"'{row.name}' in app/dashboard/table.py is taken"):
        check_names((*TABS, row))


def test_a_former_name_leads_to_a_page_and_is_none() -> None:
    """A page with that name could not be opened by its link."""
    assert {row.name for row in former_names.TABS} <= set(tab_names())
    assert not {row.former for row in former_names.TABS} & set(tab_names())


def test_every_folder_of_a_page_has_its_row() -> None:
    folders = {path.parent.name for path in (Path(__file__).parents[2] / "app" / "pages").glob("*/__init__.py")}
    assert folders == {row.page.__module__.split(".")[2] for row in PAGES}


def test_every_tab_without_a_page_over_the_pictures_is_drawn_by_the_browser_itself() -> None:
    """Such a tab has nothing to open; without its own function, it would have one sentence at most."""
    script = (Path(__file__).parents[2] / "app" / "dashboard" / "tabs.js").read_text(encoding="utf-8")
    listed = script.partition("const TAB_BODIES = {")[2].partition("};")[0]
    drawn = {name.strip('"') for name in re.findall(r'("[^"]+"|\w+):', listed)}
    assert {row.name for row in TABS if not getattr(row, "view", None)} <= drawn <= {row.name for row in TABS}


def test_a_link_keeps_room_for_what_the_browser_adds() -> None:
    """The server leaves out pins to make the rest fit; it does not know the longest tab."""
    longest = {"tab": max(tab_names(), key=len), "page": max(tab_names(), key=len),
               "look": max(share.VIEW_VALUES["look"], key=len), "embed": "1"}
    assert longest.keys() == set(share.BROWSER_FIELDS)
    assert sum(len(f"&{name}={quote(value)}") for name, value in longest.items()) <= share._ADDED_BY_BROWSER
