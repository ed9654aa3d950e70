"""The places that write the exponent of the contacts are those of docs/design.md.

The search covers the kernels and the scene, where a power or factor of Hertz's law hardly means anything else. Of the
places in other folders only the existence is tested.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

import pytest
from source import ROOT, named_parts

PAGE = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
#: Folders of the core that are searched.
_SEARCHED = ("kernels", "scene")
#: Powers and factors of Hertz's law: p = 3/2 and p + 1, their reciprocals, and those of contact times and waves.
_POWERS = {1.5, 2.5, 0.4, 0.25, 2.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0, -1.0 / 3.0, -1.0 / 6.0}
_FACTORS = {1.5, 2.5, 0.4}
#: The powers as written in texts.
_POWERS_IN_TEXTS = ("{3/2}", "{2/3}", "{5/2}")
#: Places where the law is written without such a number: as δ times its root, a polynomial, a constant, or an order.
_WITHOUT_NUMBER = {
    ("kernels/effects/contact.py", "elastic_force"), ("kernels/effects/contact.py", "three_halves"),
    ("kernels/batch/step.py", "contact"), ("kernels/equations/chain_in_vector.py", "chain_slope"),
    ("kernels/dop853_root/chain.py", "rates_at"), ("kernels/dop853_root/chain.py", "powers"),
    ("kernels/dop853_root/changes.py", "size_in_xi"), ("kernels/error_control/force_kinks.py", "scaled_force"),
    ("kernels/rk4/contact_events.py", "add_quadrature_errors"), ("kernels/flow/event_time.py", "smooth_power"),
    ("kernels/batch/contact_correction.py", "impulse_error"), ("kernels/batch/contact_correction.py", "next_step_error"),
    ("kernels/batch/contact_correction.py", "three_halves_by_series"), ("kernels/batch/contact_correction.py", "correct_contacts"),
    ("scene/description.py", "hertz_stiffness"), ("scene/validity.py", "peak_pressures"),
    ("scene/hertz.py", "HERTZ_DURATION"), ("scene/hertz.py", "HERTZ_FORCE"), ("scene/hertz.py", "SOLITARY_BY_FORCE"),
    ("scene/hertz.py", "SOLITARY_BY_VELOCITY")}


def constant(node: ast.expr) -> float | None:
    """Return the value of a numeric expression, e.g. 2.0 / 3.0; None for any other expression."""
    try:
        return float(eval(compile(ast.Expression(node), "", "eval"), {"__builtins__": {}}))
    except (NameError, TypeError, ValueError, ZeroDivisionError):
        return None


def without_docstrings(part: ast.AST) -> Iterator[ast.AST]:
    """Yield all nodes of a part of a file except docstrings."""
    yield part
    for node in ast.iter_child_nodes(part):
        if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)):
            yield from without_docstrings(node)


def is_root(node: ast.AST) -> bool:
    """Return whether a node is a call of `root` or `sqrt`."""
    return isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in ("root", "sqrt")


def writes_the_exponent(node: ast.AST) -> bool:
    """Return whether a node has a power or factor of Hertz's law, names such a power, or compares with the exponent.

    Nested roots count as such a power, and √2 as a factor of the wall's stiffness; a text may contain powers.
    """
    if isinstance(node, ast.Call) and is_root(node):
        inside = [one for argument in node.args for one in ast.walk(argument)]
        return any(map(is_root, inside)) or (len(node.args) == 1 and constant(node.args[0]) == 2.0)
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return any(power in node.value for power in _POWERS_IN_TEXTS)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        return constant(node.right) in _POWERS
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        return constant(node.left) in _FACTORS or constant(node.right) in _FACTORS
    if isinstance(node, ast.Assign):
        return isinstance(node.value, ast.BinOp) and constant(node.value) in _POWERS
    if isinstance(node, ast.Compare):
        return any(constant(one) == 1.5 for one in node.comparators)
    return isinstance(node, ast.Name) and node.id == "three_halves"


def listed_places() -> set[tuple[str, str]]:
    """Return file and name of every place in the page's table."""
    table = PAGE.partition("### The exponent 3/2\n")[2].partition("Independent references")[0]
    rows = re.findall(r"^\|.*\|$", table, re.MULTILINE)
    return {(file, name) for row in rows for file, names in re.findall(r"`([\w/]+\.py)`(?: \(([^)]*)\))?", row)
            for name in re.findall(r"`(\w+)`", names) or [""]}


def test_places_in_kernels_and_scene_that_write_the_exponent_are_those_of_the_page() -> None:
    core = ROOT / "granchain_core"
    written = {(path.relative_to(core).as_posix(), name) for folder in _SEARCHED for path in (core / folder).rglob("*.py")
               for name, part in named_parts(path) if any(map(writes_the_exponent, without_docstrings(part)))}
    assert not _WITHOUT_NUMBER & written
    assert {place for place in listed_places() if place[0].startswith(_SEARCHED)} == written | _WITHOUT_NUMBER


@pytest.mark.parametrize("file", sorted({file for file, _ in listed_places()}))
def test_places_of_the_exponent_exist(file: str) -> None:
    there = {name for name, _ in named_parts(ROOT / "granchain_core" / file)}
    assert {name for listed, name in listed_places() if listed == file} <= there
