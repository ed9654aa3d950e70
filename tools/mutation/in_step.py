"""Checks that the table of mutants matches the project: the text that each changes exists, and so do its tests.

To check the tests, pytest collects them, since a name may be that of a parameter.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from .mutant import ROOT, Mutant
from .table import BROAD, DEMANDED, MUTANTS


def problems() -> list[str]:
    """Return a sentence for each entry of the table that no longer matches the project."""
    names = Counter(one.name for one in MUTANTS)
    found = [f"{name} is {times} times in the table" for name, times in names.items() if times > 1]
    found += [f"{name} is demanded ({group}) and not in the table"
              for group, members in DEMANDED.items() for name in members if name not in names]
    for one in MUTANTS:
        found += _text_problems(one)
    found += _test_problems({BROAD, *(one.killers for one in MUTANTS), *(one.blind for one in MUTANTS if one.blind)})
    return found


def _text_problems(one: Mutant) -> Iterator[str]:
    """Check that the mutant's text is in its file, as often as stated, and leaves valid Python whose imports exist."""
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
            yield f"{one.name} imports {name}, which does not exist"
    if not 1 <= one.which <= one.count:
        yield f"{one.name}: place {one.which} of {one.count}"


def _imports(text: str, path: Path) -> set[str]:
    """Return the dotted names, from the project's root, of everything that a file imports from the project."""
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
    """Return whether a dotted name is a module of the project, or is defined at the top level of one."""
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


def _test_problems(lists: set[tuple[str, ...]]) -> Iterator[str]:
    """Check that the tests given to pytest exist: files, functions, and those that `-k` selects among them."""
    places = {word for words in lists for word in words if word.startswith("tests/")}
    files = sorted({word.partition("::")[0] for word in places})
    missing = [file for file in files if not (ROOT / file).exists()]
    yield from (f"there is no {file}" for file in missing)
    collected, problem = _collected([file for file in files if file not in missing])
    if problem:
        yield problem
        return
    there = {place: [one for one in collected if _is_of(place, one)] for place in sorted(places)}
    yield from (f"there is no test {place}" for place, tests in there.items()
                if not tests and place.partition("::")[0] not in missing)
    for words in sorted(lists):
        if "-k" in words:
            tests = [one for word in words if word in there for one in there[word]]
            yield from _choice_problems(words[words.index("-k") + 1], tests)


def _collected(files: list[str]) -> tuple[list[str], str]:
    """Return the tests in these files and folders, as pytest names them; if they cannot be collected, the reason."""
    done = subprocess.run([sys.executable, "-m", "pytest", "--collect-only", "-q", "-o", "addopts=", "-p",
                           "no:cacheprovider", *files], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return [], f"pytest does not collect the tests: {(done.stdout + done.stderr)[-2000:]}"
    return [line for line in done.stdout.splitlines() if "::" in line], ""


def _is_of(place: str, test: str) -> bool:
    """Return whether a test is that place, or in it."""
    return test == place or (test.startswith(place) and test[len(place)] in "/:[")


def _choice_problems(expression: str, tests: list[str]) -> Iterator[str]:
    """Check that each word of a `-k` expression is part of a test's name, and that it selects at least one test."""
    words = set(re.findall(r"[^\s()]+", expression)) - {"and", "or", "not"}
    names = [one.lower() for one in tests]
    unknown = sorted(word for word in words if not any(word.lower() in name for name in names))
    yield from (f"{word!r} of {expression!r} is in no test's name" for word in unknown)
    chooses = re.sub(r"[^\s()]+", lambda match: match[0] if match[0] in ("and", "or", "not")
                     else f"({match[0].lower()!r} in name)", expression)
    if not unknown and not any(eval(chooses, {"name": name}) for name in names):
        yield f"{expression!r} selects no test"
