"""The map in docs/design.md is that of the code: every folder is on it, and imports only what the map says."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from source import ROOT, imports_in, parsed

PAGE = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
#: Folder → the folders of its last column.
ROWS = {row[1]: re.findall(r"`(\w+)`", row[2])
        for row in re.finditer(r"^\| `([\w/]+)` \| [^|]+ \| ([^|]+) \|$", PAGE, re.MULTILINE)}
#: Module next to the folders → what it uses: a module, a folder, or one module of a folder.
MODULES = {row[1]: set(re.findall(r"`([\w.]+)`", row[2]))
           for row in re.finditer(r"^\| `(\w+)\.py` \| [^|]+ \| ([^|]+) \|$", PAGE, re.MULTILINE)}
#: Modules next to the folders of the kernels, and those that compile them.
KERNELS = set(re.findall(r"^\| `(\w+)\.py` \| [^|]+ \|$", PAGE, re.MULTILINE))
#: Folder whose own folders the map orders → each of these → the others that it uses.
FAMILIES = {family: {folder.split("/")[2]: uses for folder, uses in ROWS.items()
                     if re.fullmatch(rf"granchain_core/{family}/\w+", folder)} for family in ("kernels", "steady")}
#: The core's top folders, whose imports the map orders.
LAYERS = {folder.split("/")[1]: uses for folder, uses in ROWS.items() if re.fullmatch(r"granchain_core/\w+", folder)}


#: Powers and factors of Hertz's law: p = 3/2 and p + 1, their reciprocals, and those of contact times and waves.
_POWERS = {1.5, 2.5, 0.4, 0.25, 2.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0, -1.0 / 3.0, -1.0 / 6.0}
_FACTORS = {1.5, 2.5, 0.4}
#: The powers as written in texts.
_POWERS_IN_TEXTS = ("{3/2}", "{2/3}", "{5/2}")
#: Places where such a number means something else: a fraction of a record's samples, of a speed, of a record or of a
#: change, a reserve of time, an error that falls as the fourth power of the step, the √2 of a Butterworth low-pass.
_OTHER_NUMBERS = {
    ("experiment/grid.py", "_decoded"), ("runs/budget.py", "refuse_long_picture"), ("orbits/response.py", "RETURNS_IN_STEP"),
    ("observers/twin.py", "_TRANSIENT"), ("integrate/methods.py", "method_for"), ("analysis/pulse.py", "_ERROR_OVER_CHANGE"),
    ("experiment/sensors.py", "shortest_pulse"), ("experiment/sensors.py", "response")}
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
    ("integrate/methods.py", "METHODS"), ("integrate/methods.py", "_JUMP_ERROR"),
    ("scene/hertz.py", "HERTZ_DURATION"), ("scene/hertz.py", "HERTZ_FORCE"), ("scene/hertz.py", "SOLITARY_BY_FORCE"),
    ("scene/hertz.py", "SOLITARY_BY_VELOCITY"), ("analysis/pulse.py", "CONTINUUM")}


def allowed(layer: str, layers: dict[str, list[str]] = LAYERS) -> set[str]:
    """Return the layer and all layers that it uses, directly or indirectly."""
    return {layer}.union(*(allowed(one, layers) for one in layers[layer]))


def imported(path: Path) -> set[str]:
    """Return the core's modules that a file imports, dotted, without `granchain_core`."""
    found: set[str] = set()
    for module, names in imports_in(path):
        if module.split(".")[0] == "granchain_core":
            inside = module.partition(".")[2]
            found |= {inside} if inside else {name for name, _ in names}
    return found


def used(layer: str) -> set[str]:
    """Return the top-level names of the core that the files of a layer import."""
    return {name.split(".")[0] for path in (ROOT / "granchain_core" / layer).rglob("*.py") for name in imported(path)}


def test_every_folder_with_code_is_on_the_map_and_every_row_is_a_folder() -> None:
    folders = {str(path.parent.relative_to(ROOT)) for top in ("granchain", "granchain_core", "granchain_start", "app")
               for path in (ROOT / top).rglob("*.py")}
    assert set(ROWS) == folders


@pytest.mark.parametrize("layer", LAYERS)
def test_a_folder_imports_only_what_the_map_says(layer: str) -> None:
    assert used(layer) & set(LAYERS) <= allowed(layer)


@pytest.mark.parametrize("family, layer", [(family, layer) for family, layers in FAMILIES.items() for layer in layers])
def test_a_folder_of_a_family_imports_only_what_the_map_says(family: str, layer: str) -> None:
    """This is about other folders of the family; any folder may use a module next to them that does not use it."""
    home = ROOT / "granchain_core" / family
    names = {name.split(".")[1] for path in (home / layer).rglob("*.py") for name in imported(path)
             if name.startswith(f"{family}.")}
    assert names & set(FAMILIES[family]) <= allowed(layer, FAMILIES[family])
    beside = {name for module in names if (home / f"{module}.py").exists() for name in imported(home / f"{module}.py")}
    assert not [name for name in beside if name.startswith(f"{family}.{layer}")]


def test_every_module_of_the_kernels_is_named() -> None:
    kernels = ROOT / "granchain_core" / "kernels"
    files = {path.stem for folder in (kernels, kernels / "compiling") for path in folder.glob("*.py")} - {"__init__"}
    assert files == KERNELS


def test_the_map_has_no_circle() -> None:
    """Each layer is below all those that it uses."""
    for layers in (LAYERS, *FAMILIES.values()):
        order = list(layers)
        assert all(order.index(above) < order.index(layer) for layer, uses in layers.items() for above in uses)


def test_every_module_beside_the_folders_is_on_the_map_with_what_it_uses() -> None:
    files = {path.stem: path for path in (ROOT / "granchain_core").glob("*.py") if path.stem != "__init__"}
    assert set(MODULES) == set(files)
    for module, path in files.items():
        names = imported(path)
        assert {name if name in MODULES[module] else name.split(".")[0] for name in names} == MODULES[module], module


@pytest.mark.parametrize("layer", LAYERS)
def test_a_folder_uses_no_module_that_uses_it(layer: str) -> None:
    """Of the modules next to the folders, the kernels use only `errors`; no folder uses `precompile`, which uses most
    of them.
    """
    beside = used(layer) & set(MODULES)
    assert layer == "precompile" or "precompile" not in used(layer)
    assert not (layer == "kernels" and beside - {"errors"})
    assert not [module for module in beside if layer in MODULES[module]]


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


def named_parts(path: Path) -> Iterator[tuple[str, ast.stmt]]:
    """Yield the functions, methods and constants of a file by name; `__init__` goes by the name of its class."""
    for node in parsed(path).body:
        for part in node.body if isinstance(node, ast.ClassDef) else (node,):
            if isinstance(part, ast.FunctionDef):
                yield node.name if part.name == "__init__" else part.name, part  # type: ignore[union-attr]
            elif isinstance(part, ast.Assign | ast.AnnAssign):
                yield ast.unparse(part.targets[0] if isinstance(part, ast.Assign) else part.target), part


def listed_places() -> set[tuple[str, str]]:
    """Return file and name of every place in the page's table."""
    table = PAGE.partition("### The exponent 3/2\n")[2].partition("Independent references")[0]
    rows = re.findall(r"^\|.*\|$", table, re.MULTILINE)
    return {(file, name) for row in rows for file, names in re.findall(r"`([\w/]+\.py)`(?: \(([^)]*)\))?", row)
            for name in re.findall(r"`(\w+)`", names) or [""]}


def event_places() -> set[tuple[str, str]]:
    """Return file and function from the tables of events in docs/method.md; in a row, functions follow their file."""
    page = (ROOT / "docs" / "method.md").read_text(encoding="utf-8")
    found, file = set(), ""
    for row in re.findall(r"^\|.*\|$", page.partition("### Events, integrator by integrator\n")[2].partition("\n##")[0], re.MULTILINE):
        file = ""
        for name in re.findall(r"`([\w/]+(?:\.py)?)`", row):
            file = name if name.endswith(".py") else file
            if file and name != file:
                found.add((file, name))
    return found


def test_the_functions_of_the_tables_of_events_exist() -> None:
    places = event_places()
    assert len(places) > 15
    assert not {(file, name) for file, name in places if name not in dict(named_parts(ROOT / "granchain_core" / file))}


def test_every_place_that_writes_the_exponent_of_the_contacts_is_on_the_list_and_no_other() -> None:
    core = ROOT / "granchain_core"
    written = {(path.relative_to(core).as_posix(), name) for path in core.rglob("*.py") for name, part in named_parts(path)
               if any(map(writes_the_exponent, without_docstrings(part)))}
    written = {place for place in written if not place[0].startswith("hard_cases/")}
    assert written >= _OTHER_NUMBERS and not _WITHOUT_NUMBER & written
    assert listed_places() == (written - _OTHER_NUMBERS) | _WITHOUT_NUMBER


@pytest.mark.parametrize("file", sorted({file for file, _ in listed_places()}))
def test_the_places_of_the_exponent_exist(file: str) -> None:
    there = {name for name, _ in named_parts(ROOT / "granchain_core" / file)}
    assert {name for listed, name in listed_places() if listed == file} <= there


def test_the_table_of_bodies_registered_from_above_is_that_of_the_code() -> None:
    """The table lists functions to which other families give a body (`.of`), except those for the effects' slots."""
    kernels = ROOT / "granchain_core" / "kernels"
    defined = {name: path.relative_to(kernels) for path in kernels.rglob("*.py")
               for name in re.findall(r"^@by_\w+\ndef (\w+)", path.read_text(encoding="utf-8"), re.MULTILINE)}
    above = {(name, defined[name].as_posix(), path.relative_to(kernels).parts[0]) for path in kernels.rglob("*.py")
             for name in re.findall(r"^@(\w+)\.of\(", path.read_text(encoding="utf-8"), re.MULTILINE)
             if name in defined and defined[name].parts[0] not in ("effects", path.relative_to(kernels).parts[0])}
    section = PAGE.split("registered bodies come up")[1].split("###")[0]
    listed = {(name, row[2], row[3]) for row in
              re.finditer(r"^\| (`.+?)(?:: .+?)? \| `kernels/([\w/.]+)` \| `kernels/([\w.]+)", section, re.MULTILINE)
              for name in re.findall(r"`(\w+)`", row[1].split(": ")[0])}
    assert listed == above
