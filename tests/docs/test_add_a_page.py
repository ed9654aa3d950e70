"""docs/add-a-page.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from documents import ROOT, blocks
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-page.md"
#: The heading of an optional step.
PLOT = "## 7. A plot"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made, including the tests of the architecture."""
    copy = tmp_path_factory.mktemp("page") / "tree"
    for part in ("docs", "granchain", "granchain_start", "tools", "tests/session/links.json", "tests/architecture", "tests/browser",
                 "tests/dashboard/test_messages.py", "tests/dashboard/test_table.py", "tests/host.py", "tests/headless_dashboard.py", "tests/waiting.py",
                 *(f"tests/pages/{name}.py" for name in ("conftest", "page_host", "test_every_page"))):
        copied(part, copy)
    edited_copy(PAGE, copy)
    follow(copy, "-m", "tools.update")
    return copy


def test_the_page_edits_one_file_and_writes_five() -> None:
    edits, new = files_of(PAGE, PLOT)
    assert (len(edits - new), len(new)) == (1, 5)


def test_a_plot_edits_four_files_and_writes_one() -> None:
    (edits, new), (_, of_the_page) = files_of(PAGE), files_of(PAGE, PLOT)
    plot = {block.path for block in blocks(PAGE)[len(blocks(PAGE, PLOT)):]}
    assert (len(plot & edits), len(new - of_the_page)) == (4, 1)


def test_the_new_page_has_its_overlay_its_tab_and_its_hooks(tree: Path) -> None:
    """The row of a page creates an overlay, a tab, a call with every picture, and an answer to the page's own message.
    """
    printed = follow(tree, "-c", """
from types import SimpleNamespace
from bokeh.document import Document
from app.dashboard.controller import Controller
from app.session.session import Session
from app.scripts import FILES

dashboard = Controller(Document(), Session())
settled = SimpleNamespace(run=SimpleNamespace(max_output_force=1.0, max_input_force=4.0), final=False)
dashboard.session.settled = settled
page = next(one for one in dashboard.pages if type(one).__name__ == "TransmissionPage")
page.picture_ready(settled)
print(dashboard.views.overlays["transmission"].state["sentence"])
dashboard.views.overlays["transmission"].update_state(sentence="")
dashboard.received({"do": "transmission-say"})
print(dashboard.views.overlays["transmission"].state["sentence"])
document = Document()
dashboard.views.put_into(document)
print(dict(document.template_variables["overlays"])["transmission"], "transmission.js" in FILES)
print([one["placeholder"] for one in dashboard.views.tabs.state["tabs"] if one["name"] == "transmission"])
""")
    first, second, overlay, words = printed.splitlines()
    assert first == second == "25.0 % of the largest input force arrives at the wall."
    assert (overlay, words) == ("Transmission True", "['How much of the input force arrives.']")


def test_the_new_page_computes_in_the_background_until_it_is_told_to_stop(tree: Path) -> None:
    """The page's task ends when it has its result, when a knob is moved, or when the visitor leaves. Its figure has a
    point for each frequency.
    """
    printed = follow(tree, "-c", """
import sys
sys.path.insert(0, "tests")
from types import SimpleNamespace
from host import FakeHost
from app.pages.transmission.page import TransmissionPage
from app.plots.theme import THEMES
from granchain_core import scene

host, shown, figures = FakeHost(), {"running": False}, []
host.session = SimpleNamespace(scene=scene("sec2").evolve(N=2, f=600.0), picture=None)
view = SimpleNamespace(update_state=shown.update, clear_figure=figures.clear,
                       show_figure=lambda draw, words, shape: figures.append(draw(THEMES["dark"])))
page = TransmissionPage(host, view)
page.actions["transmission-search"]({})
print(shown["running"], shown["progress"])
host.run_callbacks_until(lambda: not shown["running"], 300.0)
print(shown["status"], shown["most"])
print(shown["done"])
page.actions["transmission-search"]({})
page.actions["transmission-stop"]({})
print(shown["status"], shown["running"], shown["done"])
print(len(figures[0].select_one({"name": "shares"}).data["share"]), figures[0].yaxis[0].axis_label)
page.actions["transmission-search"]({})
page.scene_changed()
print(shown["status"], shown["running"], repr(shown["most"]), figures)
page.actions["transmission-search"]({})
host.leave()
host.run_callbacks_until(lambda: not host.callbacks)
print(shown["status"])
""")
    begun, found, done, stopped_by_hand, drawn, stopped, left = printed.splitlines()
    assert (begun, stopped, left) == ("True waiting for its turn …", "stopped False '' []", "waiting")
    assert (done, stopped_by_hand) == ("1.0", "stopped False 0.0")
    assert drawn == "17 share of the input force (%)"
    assert found.startswith("done The largest share arrives at ") and found.endswith(" Hz.")


def test_the_tables_of_pages_and_messages_have_the_new_page(tree: Path) -> None:
    design, dashboard = ((tree / "docs" / name).read_text(encoding="utf-8") for name in ("design.md", "dashboard.md"))
    assert "| `app/pages/transmission` | How much of the input force arrives at the wall | – |\n" in design
    assert "| page `transmission` | `transmission-say`, `transmission-search`, `transmission-stop` |\n" in dashboard


@pytest.mark.long
def test_the_new_page_fits_into_the_dashboard(tree: Path) -> None:
    """It passes the tests of layers, private attributes, docstrings, the map in docs/design.md, and messages."""
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", str(Path("tests", "architecture")),
                     str(Path("tests", "dashboard")), "-k", "transmission or table or map or circle or message")
    assert " passed" in printed and "deselected" in printed


def test_the_new_page_passes_the_tests_of_every_page(tree: Path) -> None:
    """These tests need no browser; they take the page from the table of pages, without a change."""
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", str(Path("tests", "pages", "test_every_page.py")),
                     "-k", "transmission", own_kernels=False)
    assert re.search(r"^\d\d passed, \d+ deselected in", printed, re.MULTILINE), "none failed, and none was skipped"


@pytest.mark.long
def test_a_browser_shows_words_and_figure_of_the_new_page(tree: Path) -> None:
    """The test written by the page passes; no kernel is edited, so it uses those of the repository."""
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider",
                     str(Path("tests", "browser", "test_transmission_page.py")), own_kernels=False)
    assert "1 passed" in printed
