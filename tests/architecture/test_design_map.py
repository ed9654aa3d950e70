"""The map in docs/design.md is that of the code: every folder is on it, and imports only what the map says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from source import ROOT, imports_in, named_parts

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
