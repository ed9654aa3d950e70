"""Whether the table of mutants is in step with the core: the text each changes is there, and the tests it names."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from .mutant import ROOT, Mutant
from .table import BROAD, DEMANDED, MUTANTS


def problems() -> list[str]:
    """One sentence for each entry of the table that no longer fits the project; none where the table is in step."""
    names = Counter(one.name for one in MUTANTS)
    found = [f"{name} stands {times} times in the table" for name, times in names.items() if times > 1]
    found += [f"{name} is demanded ({group}) and not in the table"
              for group, members in DEMANDED.items() for name in members if name not in names]
    for one in MUTANTS:
        found += _text_problems(one)
    for words in {BROAD, *(one.killers for one in MUTANTS), *(one.blind for one in MUTANTS)}:
        found += _test_problems(words)
    return found


def _text_problems(one: Mutant) -> Iterator[str]:
    """Whether the mutant's text is in its file, as often as it says, and what it leaves is Python whose imports exist.
    """
    path = ROOT / one.path
    if not path.exists():
        yield f"{one.name}: there is no file {one.path}"
        return
    text = path.read_text(encoding="utf-8")
    try:
        changed = one.applied(text)
        compile(changed, one.path, "exec")
    except (ValueError, SyntaxError) as problem:
        yield f"{one.name}: {problem}"
        return
    if changed == text:
        yield f"{one.name} changes nothing"
    for name in sorted(_imports(changed, path) - _imports(text, path)):
        if not _is_there(name):
            yield f"{one.name} imports {name}, which is not there"
    if not 1 <= one.which <= one.count:
        yield f"{one.name}: place {one.which} of {one.count}"


def _imports(text: str, path: Path) -> set[str]:
    """Dotted names, from the project's root, of all that a file imports from the project."""
    package = path.relative_to(ROOT).parent.parts
    found = set()
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.ImportFrom):
            continue
        above = package[: len(package) + 1 - node.level] if node.level else ()
        names = ".".join((*above, *filter(None, [node.module])))
        if names.partition(".")[0] in ("granchain_core", "tests"):
            found |= {f"{names}.{one.name}" for one in node.names}
    return found


def _is_there(name: str) -> bool:
    """Whether a dotted name is a module of the project, or stands at the top level of one."""
    place = ROOT.joinpath(*name.split("."))
    if place.with_suffix(".py").exists() or place.is_dir():
        return True
    module = place.parent / "__init__.py" if place.parent.is_dir() else place.parent.with_suffix(".py")
    if not module.exists():
        return False
    bound: set[str] = set()
    for node in ast.parse(module.read_text(encoding="utf-8")).body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            bound.add(node.name)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            bound |= {one.asname or one.name for one in node.names}
        else:
            bound |= {one.id for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}
    return place.name in bound


def _test_problems(words: tuple[str, ...]) -> Iterator[str]:
    """Whether the test files and functions that pytest is given exist."""
    for word in words:
        if not word.startswith("tests/"):
            continue
        file, _, name = word.partition("::")
        function = name.partition("[")[0]
        if not (ROOT / file).exists():
            yield f"there is no {file}"
        elif function and f"def {function}(" not in (ROOT / file).read_text(encoding="utf-8"):
            yield f"{file} has no {function}"
