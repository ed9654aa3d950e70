"""Read the imports of the project's Python files, for the tests of its architecture."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]


class Import(NamedTuple):
    """One import: the absolute dotted module, and the names imported from it, each with its local name.

    For `import …`, there are no names.
    """

    module: str
    names: tuple[tuple[str, str], ...] = ()


@functools.cache
def parsed(path: Path) -> ast.Module:
    """Return the syntax tree of a file, which the tests share and do not change."""
    return ast.parse(path.read_text(encoding="utf-8"))


@functools.cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """Return all nodes of a file's syntax tree."""
    return tuple(ast.walk(parsed(path)))


def by_folder(paths: Iterable[Path]) -> dict[str, list[Path]]:
    """Group files by folder, relative to the root: one test examines a folder, and its message names the file."""
    found: dict[str, list[Path]] = {}
    for path in paths:
        found.setdefault(path.parent.relative_to(ROOT).as_posix(), []).append(path)
    return found


@functools.cache
def imports_in(path: Path, everywhere: bool = True) -> tuple[Import, ...]:
    """Return what a file imports: everywhere, including functions and type checking, or only at the top level."""
    package = path.relative_to(ROOT).parts[:-1]
    found: list[Import] = []
    for node in nodes(path) if everywhere else parsed(path).body:
        if isinstance(node, ast.Import):
            found += [Import(alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            found.append(Import(".".join([*above, *([node.module] if node.module else [])]),
                                tuple((alias.name, alias.asname or alias.name) for alias in node.names)))
    return tuple(found)
