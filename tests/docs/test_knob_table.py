"""Generated parts of pages are as `python -m tools.update` writes them, and `Scene` documents its knobs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from documents import ROOT

from granchain_core import Scene
from granchain_core.scene.quantities import QUANTITIES, Quantity
from tools import gallery, scales
from tools.lists import allowed
from tools.update import PAGES, pages


@pytest.fixture(scope="module")
def texts() -> dict[Path, str]:
    """Every page as it should be; generating all of them takes half a second."""
    return pages()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: Path(page).stem)
def test_a_table_is_that_of_the_code(page: str, texts: dict[Path, str]) -> None:
    assert ROOT.joinpath(page).read_text(encoding="utf-8") == texts[ROOT / page]  # otherwise run: python -m tools.update


def test_no_scene_has_changed_since_its_pictures_were_made() -> None:
    assert (scales.changed(), gallery.changed()) == ([], [])  # otherwise run: python -m tools.update


@pytest.mark.parametrize(("knob", "values"), [
    ("f", "0.1 to 1e6"), ("A0", "1e-12 to 0.0001"), ("N", "1 to 10000, whole"), ("drive", "`harmonic`, `rest`"),
    ("wall", "`bead`, `same-material`, `rigid`, or 1e-6 to 1e6"),
])
def test_the_values_of_a_knob_are_printed_in_words(knob: str, values: str) -> None:
    assert allowed(QUANTITIES[knob]) == values


@pytest.mark.parametrize("knob", [one for one in QUANTITIES.values() if one.name != "kappa"], ids=lambda knob: knob.name)
def test_the_docstring_of_a_scene_has_the_knob_and_its_unit(knob: Quantity) -> None:
    entry = re.search(rf"^    {knob.name} : .*\n((?: {{8}}.*\n)+)", str(Scene.__doc__), re.MULTILINE)
    assert entry is not None
    assert knob.unit in ("", "1") or f"[{knob.unit}]" in entry[1]
