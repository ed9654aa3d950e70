"""The imports of the project's Python files, for the tests of its architecture."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]


class Import(NamedTuple):
    """One import: the module, dotted and absolute, and the names taken from it with what they are called here.

    `import …` takes no names.
    """

    module: str
    names: tuple[tuple[str, str], ...] = ()


@functools.cache
def parsed(path: Path) -> ast.Module:
    """A file as a syntax tree, which the tests share and leave as it is."""
    return ast.parse(path.read_text(encoding="utf-8"))


@functools.cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """All nodes of a file's syntax tree."""
    return tuple(ast.walk(parsed(path)))


def by_folder(paths: Iterable[Path]) -> dict[str, list[Path]]:
    """The files of each folder, by its name from the root: one test looks at a folder, and its words name the file."""
    found: dict[str, list[Path]] = {}
    for path in paths:
        found.setdefault(path.parent.relative_to(ROOT).as_posix(), []).append(path)
    return found


@functools.cache
def imports_in(path: Path, everywhere: bool = True) -> tuple[Import, ...]:
    """What a file imports: everywhere, in functions and for type checking too, or only at its top."""
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
