"""docs/add-a-knob.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-knob.md"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = tmp_path_factory.mktemp("knob") / "tree"
    for part in ("granchain", "granchain_start", "tools", "docs"):
        copied(part, copy)
    return edited_copy(PAGE, copy)


def test_the_page_edits_two_files_and_writes_none() -> None:
    edits, new = files_of(PAGE)
    assert len(edits) == 2 and not new


def test_the_new_knob_changes_the_scene_and_is_checked(tree: Path) -> None:
    printed = follow(tree, "-c", """
from dataclasses import replace
from granchain_core import BadInput, Scene, scene
chain = scene("sec2").evolve(tail=2.0)
print([round(float(mass / chain.masses()[0]), 6) for mass in chain.masses()[[1, -1]]], "tail : float" in Scene.__doc__)
for wrong in (lambda: chain.evolve(tail=0.0), lambda: replace(chain, tail=-1.0)):
    try:
        wrong()
    except BadInput as problem:
        print(problem)
old = {name: value for name, value in scene("sec2").to_json().items() if name != "tail"}
print(Scene.from_json(old) == scene("sec2"))
""", own_kernels=False).splitlines()
    assert printed[0] == "[1.0, 2.0] True" and printed[-1] == "True"
    assert [one.startswith("mass of bead N tail = ") for one in printed[1:-1]] == [True, True]


def test_the_new_knob_is_in_links_on_the_page_and_in_the_docs(tree: Path) -> None:
    printed = follow(tree, "-c", """
from app.parts.knobs.knobs import knob_state
from app.session.scene_facts import slider_range
from app.session.session import Session
from app.session.share import decode
from granchain_core import scene
chain = scene("sec2").evolve(tail=2.0)
print(decode(Session(scene=chain).link)[0].tail, slider_range(chain, "tail"))
(spec,) = [one for one in knob_state(chain)["specs"] if one["name"] == "tail"]
print(spec["short"], spec["more"], spec["scale"])
from tools.update import pages
print("| `tail` | m_t/m | 1 | 0.001 to 1000 |" in "".join(pages().values()))
""", own_kernels=False).splitlines()
    assert printed == ["2.0 (0.001, 1000.0)", "last bead True log", "True"]


def test_the_new_knob_is_set_on_the_command_line(tree: Path) -> None:
    """A heavier last bead changes the forces; no kernel is edited."""
    command = ("-m", "app.cli", "run", "sec2", "--set", "N=2", "--set", "f=2000", "--json")
    one, other = (json.loads(follow(tree, *command, *more, own_kernels=False)) for more in ((), ("--set", "tail=2")))
    assert one != other
