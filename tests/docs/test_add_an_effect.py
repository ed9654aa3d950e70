"""docs/add-an-effect.md, docs/add-a-quadratic-drag.md and docs/add-a-cubic-spring.md are followed to the letter in
copies of the repository.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from documents import ROOT, blocks
from edited_tree import copied, edited_copy, files_of, follow, import_with

from granchain_core.kernels.effects.registry import in_simd_kernels

PAGE = ROOT / "docs" / "add-an-effect.md"
QUADRATIC = ROOT / "docs" / "add-a-quadratic-drag.md"
SPRING = ROOT / "docs" / "add-a-cubic-spring.md"
#: The headings under which the effect is mentioned.
MENTIONED = {PAGE: "## 5. Mention it, and let a tool write the rest", QUADRATIC: "## 5. Mention it",
             SPRING: "## 5. Mention it"}
#: Numbers of files that each page edits, writes, and edits to mention the effect.
COUNTS = {PAGE: (6, 3, 1), QUADRATIC: (6, 3, 1), SPRING: (6, 3, 1)}


def written_tests(page: Path) -> set[str]:
    """Return the names of the tests that a page writes."""
    return {name for block in blocks(page) if block.is_new_file for name in re.findall(r"^def (test_\w+)", block.text, re.MULTILINE)}


def passed(tree: Path, part: str = "tests/physics") -> set[str]:
    """Return the names of the tests in a part of a tree; none may fail, since `follow` asserts that pytest succeeds."""
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", "-rA", part)
    return set(re.findall(r"^PASSED \S+::(test_\w+)", printed, re.MULTILINE))


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the edits of the linear drag made."""
    return edited_copy(PAGE, tmp_path_factory.mktemp("effect") / "tree")


@pytest.fixture(scope="module")
def quadratic(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Another copy, with the edits of the quadratic drag made."""
    return edited_copy(QUADRATIC, tmp_path_factory.mktemp("quadratic") / "tree")


@pytest.mark.parametrize("page", [PAGE, QUADRATIC, SPRING], ids=lambda page: page.stem)
def test_the_page_edits_and_writes_few_files(page: Path) -> None:
    edits, new = files_of(page, MENTIONED[page])
    mentions = files_of(page)[0] - edits
    assert (len(edits), len(new), len(mentions)) == COUNTS[page] and files_of(page)[1] == new


def test_a_force_that_is_not_linear_in_the_velocity_passes_the_tests_the_page_writes(quadratic: Path) -> None:
    """They cover the tangent (by differences and by a second route), energy, the stable step and the stated error."""
    assert passed(quadratic) == written_tests(QUADRATIC)


def test_a_spring_passes_the_tests_the_page_writes_and_a_slope_that_is_not_inserted_is_noticed(tmp_path: Path) -> None:
    """Nothing is compiled: the tests call the terms and the equations as functions of Python."""
    tree = edited_copy(SPRING, tmp_path / "tree")
    assert passed(tree, "tests/kernels/equations/test_cubic_spring.py") == written_tests(SPRING)
    file = tree / "granchain_core" / "kernels" / "equations" / "body_forces.py"
    text = file.read_text(encoding="utf-8")
    inserted = "return add_cubic_spring_slope(slots.cubic_spring, slope, u, du, inverse_mass * dt_ds)"
    assert text.count(inserted) == 1
    file.write_text(text.replace(inserted, "return slope"), encoding="utf-8")
    with pytest.raises(AssertionError, match=r"FAILED .*test_every_slope_of_an_effect_is_inserted"):
        follow(tree, "-m", "pytest", "-p", "no:cacheprovider", "-rf", "tests/kernels/equations/test_body_forces.py", "-k", "inserted")


def test_the_new_effect_passes_the_tests_the_page_writes(tree: Path) -> None:
    """Force, energy and tangent of the page's effect are right in every kernel."""
    assert passed(tree) == written_tests(PAGE)


@pytest.mark.long
@pytest.mark.parametrize("made", ["tree", "quadratic"])
def test_the_tests_that_know_every_scene_and_knob_know_the_new_ones(made: str, request: pytest.FixtureRequest) -> None:
    """The tests of README, model page, share links, scales and gallery pass once the tool has been run."""
    tree = request.getfixturevalue(made)
    for part in ("tests/docs", "tests/session", "tests/dashboard", "tests/host.py", "tests/headless_dashboard.py", "tests/waiting.py", "docs", "tools", "CHANGELOG.md", "CONTRIBUTING.md"):
        copied(part, tree)
    written = follow(tree, "-m", "tools.update")
    assert all(file in written for file in ("README.md", "docs/model.md", "links.json", "[drag]", "drag.svg"))
    printed = follow(tree, "-m", "pytest", "-p", "no:cacheprovider", "tests/session/test_share.py", "tests/dashboard/test_scales.py::test_every_scene_has_a_scale",
                     "tests/dashboard/test_gallery.py::test_every_scene_has_a_picture_and_there_are_no_others",
                     "tests/dashboard/test_gallery.py::test_a_card_has_title_sentence_question_and_its_picture",
                     "tests/docs/test_pages.py::test_every_scene_is_in_the_readme_and_every_knob_in_the_model",
                     "tests/docs/test_knob_table.py")
    assert " passed" in printed and "failed" not in printed


def test_slopes_of_forces_know_the_new_effect(tree: Path) -> None:
    """v̇ of every bead, which enters Ḟ, agrees with the difference of velocities slightly later and earlier."""
    printed = follow(tree, "-c", """
import numpy as np
from granchain_core import scene
from granchain_core.integrate import Engine, fixed_step_setting
from granchain_core.scene.state import State
from granchain_core.kernels.forces.largest import acceleration
one = scene("drag").evolve(N=3, c=100.0)
engine = Engine(one, fixed_step_setting(), 1)
lo, work = engine.scaled, engine.stepper.work
engine.start(State(np.array([3.0, 2.0, 1.0]) * lo.scales.length, np.array([1.0, -0.5, 2.0]) * lo.scales.velocity))
y, dy, h = engine.y.copy(), work.k[0].copy(), 1e-5
engine.evaluate()
found = [acceleration(lo.slots, y, dy, work.forces.e, i, -1, False) for i in range(1, 4)]
there = []
for sign in (1.0, -1.0):
    moved = y + sign * h * dy
    engine.stepper.evaluate_at_phase(sign * h * lo.beta, moved, False)
    there.append(work.k[0][1:4].copy())
exact = (there[0] - there[1]) / (2.0 * h)
print(np.abs(found - exact).max() / np.abs(exact).max())
""")
    assert float(printed) < 1e-6  # h² of the difference, and 1e-16/h


def test_vectors_that_do_not_know_the_new_effect_refuse_it(tree: Path) -> None:
    """It is unmarked, or marked for kernels other than those of dop853-root: a motion without the drag would be wrong.
    """
    file = tree / "granchain_core" / "kernels" / "effects" / "drag.py"
    text = file.read_text(encoding="utf-8")
    mark = '@in_simd_kernels("rk4", "batch", "dop853_root")\n'
    assert text.count(mark) == 1
    try:
        for less, shares in (("", "False"), ('@in_simd_kernels("rk4", "batch")\n', "True")):
            file.write_text(text.replace(mark, less), encoding="utf-8")
            printed = follow(tree, "-c", """
from granchain_core import BadInput, run, scene
from granchain_core.integrate.batch import can_share_batch
try:
    run(scene("drag"), periods=1, method="dop853-root")
except BadInput as problem:
    print(can_share_batch(scene("drag")), problem)
""")
            assert printed.startswith(shares) and "use dop853 for this one. It does not support: drag." in printed
    finally:
        file.write_text(text, encoding="utf-8")


def test_a_mark_names_folders_of_vectors() -> None:
    with pytest.raises(TypeError, match="name those with terms of the slot, of rk4, batch, dop853_root"):
        in_simd_kernels("effects")


def test_the_new_effect_is_seen_and_its_absence_leaves_nothing(tree: Path) -> None:
    """The scene lists it, the equation shows it, and a scene without it has no slot."""
    printed = follow(tree, "-c", """
from app.cli.explain import explanation
from granchain_core import scene
from granchain_core.integrate.scaling import scale_chain
one = scene("drag")
print(one.effects, one.equation_latex(), one.evolve(c=0.0).effects)
print(scale_chain(one.evolve(c=0.0)).slots.drag)
from granchain_core.scene.cite import citations
print(dict(citations(one))["ground drag"])
print(explanation(one, None, 96))
""")
    first, absent, source, *explained = printed.splitlines()
    assert "ground drag" in first.split("]")[0] and r"- c\,\dot u_i" in first
    assert "ground drag" not in first.rsplit("[", 1)[1] and absent == "None" and "Stokes" in source
    assert "ground drag (Drag)" in explained[0]


def test_the_new_effect_has_a_switch_in_the_panel_a_slider_a_cost_and_axes(tree: Path) -> None:
    """The switch turns it off and on, with different kernels; the knob is under "more", and branches can follow it."""
    printed = follow(tree, "-c", """
from app.session.session import Session
from app.session.switches import SWITCHES, present, variants
from app.parts.knobs.knobs import knob_state
from granchain_core import scene
from granchain_core.parameter_maps.grid import KNOBS
from granchain_core.orbits import CONTINUOUS
from granchain_core.precompile.warm import structure
session = Session(scene=scene("drag"))
print(SWITCHES["drag"].title, "|", present("drag", session.scene, False))
for on in (False, True):
    session.switch("drag", on)
    print(session.scene.c, structure(session.scene))
print(scene("sec2").c, [one.scene.c for one in variants("drag", scene("sec2"))])
print([spec["more"] for spec in knob_state(session.scene)["specs"] if spec["name"] == "c"], "c" in KNOBS, "c" in CONTINUOUS)
""").splitlines()
    assert printed == ["ground drag | True", "0.0 linear, vector of 16", "20.0 linear+drag, vector of 16", "0.0 [10.0, 0.0]",
                    "[True] True True"]


@pytest.mark.parametrize(("path", "right", "wrong", "sentence"), [
    ("kernels/effects/drag.py", "@drag_loss.of(Drag)\n", "", "Drag (granchain_core.kernels.effects.drag) has no `drag_loss`"),
    ("integrate/scaling.py", '    "drag": lambda', '    "dragged": lambda',
     "effect 'drag': scaling.py does not say how its slot 'drag' is filled"),
    ("kernels/equations/motion.py", "    drag: Any = None\n", "",
     "effect 'drag': Slots (kernels/equations/motion.py) has no field 'drag'"),
    ("scene/quantities.py", 'Quantity("c", "c"', 'Quantity("C", "c"', "effect 'drag': its knob 'c' is not among QUANTITIES"),
])
def test_what_the_effect_forgets_is_named(tree: Path, path: str, right: str, wrong: str, sentence: str) -> None:
    """Nothing is computed: the first import names the missing part and its effect."""
    assert f"TypeError: {sentence}" in import_with(tree, path, right, wrong)
