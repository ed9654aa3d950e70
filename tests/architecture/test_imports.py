"""Imports: there are no circles, `app` keeps to its layers, and private attributes of libraries are used only where the
tables say.
"""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from panel.custom import JSComponent
from source import ROOT, by_folder, imports_in, nodes

import app.server  # noqa: F401  (makes every component and table known)
from app import library_internals
from app.parts.figures.result_figure import ResultFigure
from app.parts.figures.streamed_figure import StreamedFigure
from app.parts.toolkit.component import Component
from app.scripts import FILES
from granchain_core.kernels.compiling import cache, link_only


def module_name(path: Path) -> str:
    """Return the dotted name of a file; an `__init__` is its package."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_name(path): path for name in ("granchain_core", "app") for path in sorted((ROOT / name).rglob("*.py"))}
#: The modules of each folder.
FOLDERS = {folder: [module_name(path) for path in paths] for folder, paths in by_folder(MODULES.values()).items()}


def imports(module: str) -> set[str]:
    """Return all modules that a file imports: at the top, in functions, and for type checking."""
    found: set[str] = set()
    for base, names in imports_in(MODULES[module]):
        found |= {f"{base}.{name}" if f"{base}.{name}" in MODULES else base for name, _ in names} or {base}
    return {name for name in found if name in MODULES}


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """Return groups of modules that can be reached from each other (Tarjan's strongly connected components)."""
    number: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(module: str) -> None:
        number[module] = lowest[module] = len(number)
        stack.append(module)
        for target in graph[module]:
            if target not in number:
                visit(target)
                lowest[module] = min(lowest[module], lowest[target])
            elif target in stack:
                lowest[module] = min(lowest[module], number[target])
        if lowest[module] == number[module]:
            place = stack.index(module)
            if len(stack) - place > 1 or module in graph[module]:
                found.append(sorted(stack[place:]))
            del stack[place:]

    for module in graph:
        if module not in number:
            visit(module)
    return found


def test_a_circle_is_found() -> None:
    """The graph has two circles, one of them a module that imports itself, and a tail in no circle."""
    graph = {"a": {"b"}, "b": {"c", "d"}, "c": {"a"}, "d": {"e"}, "e": set(), "f": {"f", "a"}}
    assert circles(graph) == [["a", "b", "c"], ["f"]]


def test_no_import_goes_in_a_circle() -> None:
    assert circles({module: imports(module) for module in MODULES}) == []


#: The folders of `app` in the map of docs/design.md, dotted, with what its last column says they use.
USES = {folder.replace("/", "."): re.findall(r"`(\w+)`", uses) for folder, uses in re.findall(
    r"^\| `app/([\w/]+)` \| [^|]+ \| ([^|]+) \|$", (ROOT / "docs" / "design.md").read_text(encoding="utf-8"), re.MULTILINE)}
#: Modules next to the folders that any folder may use; the other modules are above all folders.
SHARED = {"format", "former_names", "frames", "library_internals", "scripts"}


#: Folders whose own folders the map orders. Other folders may use all of these, except that only `dashboard` may use
#: the folders of `pages`.
FAMILIES = {folder.split(".")[0] for folder in USES if "." in folder} - {"plots"}


def layer(module: str) -> str:
    """Return the folder of a module of `app`, including the inner one in a family; for a module next to the folders,
    its name.
    """
    parts = module.split(".")[1:]
    return ".".join(parts[:2]) if parts[0] in FAMILIES and len(parts) > 2 else parts[0]


@functools.cache
def allowed(folder: str) -> set[str]:
    """Return the folders that a folder may import: itself, those it uses, and those they use.

    A member of a family may also use what its family uses, and names other members by their last name.
    """
    family, _, inside = folder.partition(".")
    used = [f"{family}.{one}" if inside and f"{family}.{one}" in USES else one for one in USES[folder]]
    used += USES[family] if inside else [one for one in USES if one.startswith(f"{folder}.") and folder != "pages"]
    return {folder}.union(*(allowed(one) for one in used))


def test_the_order_of_the_map_is_read() -> None:
    """Families have their own folders, and folders that use a family may use its members."""
    assert {"serve", "parts", "pages"} == FAMILIES
    assert allowed("serve.compiling") == {"serve.compiling", "serve.computing", "serve.monitoring"}
    assert {"parts.toolkit", "serve.document", "plots"} <= allowed("parts.time_figures")
    assert not {"parts.chain", "curve", "pages"} & allowed("parts.time_figures")
    assert {"parts.chain", "serve.computing"} <= allowed("pages.map") and "pages.probe" not in allowed("pages.map")


@pytest.mark.parametrize("folder", [folder for folder in FOLDERS if folder.startswith("app")])
def test_a_folder_of_the_app_imports_only_what_the_map_says(folder: str) -> None:
    """Pages import their host but not the controller, parts import no page, and the command line only plots and the
    server.
    """
    pairs = [(module, name) for module in FOLDERS[folder] if module != "app"
             for name in sorted(imports(module)) if name.startswith("app.")]
    for module, name in pairs:
        mine, theirs = layer(module), layer(name)
        if mine in SHARED:
            assert theirs in SHARED, f"{module} imports {name}"
        elif module == "app.cli.serve":
            assert name in ("app.server", "app.former_names", "app.library_internals", "app.cli.common", "app.cli.options", "app.cli.waiting",
                            "app.serve.http.limits"), f"{module} imports {name}"
        elif mine in USES:
            fits = allowed(mine) | ({one for one in USES if one.startswith("pages.")} if mine == "dashboard" else set())
            assert theirs in fits | SHARED, f"{module} imports {name}"


@pytest.mark.parametrize("name", FILES)
def test_a_script_imports_only_from_folders_that_the_map_allows(name: str) -> None:
    """The rules are those for Python; the folder that assembles the dashboard may also import pages."""
    folder = FILES[name].parent
    theirs = {(folder / url).resolve().parent.relative_to(ROOT / "app").as_posix().replace("/", ".")
              for url in re.findall(r'^import [^"]*"([^"]+)";$', FILES[name].read_text(encoding="utf-8"), re.MULTILINE)}
    mine = folder.relative_to(ROOT / "app").as_posix().replace("/", ".")
    assert theirs <= allowed(mine) | ({one for one in USES if one.startswith("pages.")} if mine == "dashboard" else set())


def components(of: type) -> Iterator[type]:
    """Yield all component classes of the page."""
    for one in of.__subclasses__():
        yield from components(one)
        yield one


@pytest.mark.parametrize("part", sorted({one for one in components(Component) if one.__module__.startswith("app.")},
                                        key=lambda one: one.__name__))
def test_a_component_loads_only_styles_of_folders_that_it_may_import(part: Any) -> None:
    """A page uses the styles of app/parts and its own, but not those of another page."""
    folders = {path.read_text(encoding="utf-8"): path.parent for path in (ROOT / "app").rglob("*.css")}
    mine = layer(part.__module__)
    fits = allowed(mine) | ({one for one in USES if one.startswith("pages.")} if mine == "dashboard" else set())
    for sheet in part._stylesheets:
        assert folders[sheet].relative_to(ROOT / "app").as_posix().replace("/", ".") in fits


def test_the_core_imports_nothing_of_the_app() -> None:
    assert [(m, name) for m in MODULES if m.startswith("granchain_core") for name in imports(m) if name.startswith("app")] == []


def test_every_folder_says_in_one_line_what_it_is_for() -> None:
    for path in MODULES.values():
        init = path.parent / "__init__.py"
        assert init.exists(), f"{path.parent} has no __init__.py"
        purpose = ast.get_docstring(ast.parse(init.read_text(encoding="utf-8"))) or ""
        assert purpose.split("\n")[0].endswith("."), f"{init} does not say what its folder is for"


#: Names with an underscore that Panel documents for custom components.
DOCUMENTED = {"_esm", "_stylesheets", "_handle_msg", "_send_msg"}


#: Public names that begin with an underscore.
_OF_NAMED_TUPLES = {"_fields", "_replace", "_asdict", "_make"}


#: Private names that are passed as keyword arguments, which `private_uses` does not examine.
PARAMETERS = {"_with_props"}


def private_uses(module: str) -> Iterator[str]:
    """Yield private attributes of other objects that a module uses, with a dot or by name."""
    for node in nodes(MODULES[module]):
        if isinstance(node, ast.Attribute):
            if not node.attr.startswith("_") or ast.unparse(node.value) in ("self", "cls", "os"):
                continue
            name = node.attr
        elif isinstance(node, ast.Call) and ast.unparse(node.func) in ("getattr", "hasattr", "setattr", "delattr") \
                and isinstance(node.args[1], ast.Constant):
            name = str(node.args[1].value)
        else:
            continue
        if name.startswith("_") and not name.startswith("__") and name not in _OF_NAMED_TUPLES:
            yield name


def documented(page: str, folder: str) -> dict[str, set[str]]:
    """Return the private names in a page's tables, by the module in the second column."""
    rows: dict[str, set[str]] = {}
    for what, where in re.findall(r"^\| ([^|]+) \| ([^|]+) \| [^|]+ \|$",
                                  (ROOT / "docs" / page).read_text(encoding="utf-8"), re.MULTILINE):
        names = set(re.findall(r"`(_[a-z]\w*)`", what))
        if names and (file := re.search(rf"`({folder}/[\w/]+)\.py`", where)):
            rows.setdefault(file[1].replace("/", "."), set()).update(names)
    return rows


#: Undocumented names of Tornado, Bokeh, Panel and Param, by the only module that uses them.
INTERNALS = {module: {name for row in table for name in row.names} for module, table in library_internals.tables().items()}
#: The private ones among these names.
PRIVATE = {module: {name for name in names if re.match("_[a-z]", name)} for module, names in INTERNALS.items()}
#: Private names of Numba, by module of the core, including names that a class inherits, which `private_uses` does not
#: find.
PRIVATE_OF_NUMBA = {f"granchain_core.{module}": names for module, names in documented("compiling.md", "kernels").items()}


@pytest.mark.parametrize("folder", FOLDERS)
def test_private_attributes_of_others_are_in_the_table_of_the_module_that_uses_them(folder: str) -> None:
    for module in FOLDERS[folder]:
        used = set(private_uses(module))
        if folder.startswith("app"):
            expected = PRIVATE.get(module, set())
            assert used | (PARAMETERS & expected) == expected, module
            assert module in INTERNALS or "\nINTERNALS = " not in MODULES[module].read_text(encoding="utf-8"), module
        else:
            assert used <= PRIVATE_OF_NUMBA.get(module, set()), module


def test_the_tables_name_modules_that_are_there() -> None:
    assert PRIVATE and PRIVATE_OF_NUMBA and {*PRIVATE, *PRIVATE_OF_NUMBA} <= set(MODULES)


@pytest.mark.parametrize("module", INTERNALS)
def test_a_module_uses_what_is_in_its_table(module: str) -> None:
    """It uses them with a dot, by name, or by importing them; for another module's logger, only the name is used."""
    tree = ast.parse(MODULES[module].read_text(encoding="utf-8"))
    tree.body = [node for node in tree.body if not isinstance(node, ast.Assign) or ast.unparse(node.targets[0]) != "INTERNALS"]
    words = {word for node in ast.walk(tree) for word in (
        getattr(node, "attr", None), getattr(node, "arg", None), getattr(node, "id", None), getattr(node, "name", None),
        getattr(node, "value", None) if isinstance(node, ast.Constant) else None)}
    assert INTERNALS[module] <= words | ({"log"} if module == "app.serve.monitoring.logs" else set())


#: Attributes of documented classes that app/serve/document/changes.py uses: Bokeh's documents, models and their events,
#: Panel's state, Tornado's streams and locks, NumPy's arrays, and Python's own classes.
DOCUMENTED_ATTRIBUTES = {
    "acquire", "add_done_callback", "append", "closed", "done", "result", "rpartition", "write", "state", "loaded",
    "char", "dtype", "nbytes", "shape", "tobytes", "attr", "cols", "data", "document", "event_name", "id", "model",
    "msg_data", "msg_type", "new", "session_context", "update", "encode", "extend", "items", "join",
}


def test_public_names_used_of_bokeh_are_in_the_table() -> None:
    """Most of these are documented; changes.py lists the others in its table."""
    module = "app.serve.document.changes"
    tree = ast.parse(MODULES[module].read_text(encoding="utf-8"))
    names = [alias.asname or alias.name for node in tree.body if isinstance(node, ast.Import) for alias in node.names]
    own = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)} | {"arrays", "connection"}
    used = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)
            and ast.unparse(node.value).split(".")[0] not in ({"self", *names} - {"pn"})}
    assert used - own - DOCUMENTED_ATTRIBUTES <= INTERNALS[module]


def test_names_used_of_numba_are_in_the_documentation() -> None:
    """This includes names that classes of the core inherit from Numba's classes."""
    for module, names in (("cache", cache._NEEDED), ("link_only", link_only._NEEDED)):
        private = {name for name in names if name.startswith("_")}
        assert private <= PRIVATE_OF_NUMBA[f"granchain_core.kernels.compiling.{module}"]


def test_parts_override_only_documented_methods_of_panel() -> None:
    """This applies to their own classes and to the mixins; exceptions are in the table of one module."""
    parts = [Component, *Component.__subclasses__(), *StreamedFigure.__subclasses__(),
             *ResultFigure.__subclasses__()]
    assert len(parts) > 10
    for part in parts:
        for one in part.__mro__:
            if one.__module__.startswith("app."):
                own = {name for name in vars(one)
                       if name.startswith("_") and not name.startswith(("__", "_param", "_data_model"))}
                assert {name for name in own if hasattr(JSComponent, name)} <= DOCUMENTED | PRIVATE.get(one.__module__, set())
