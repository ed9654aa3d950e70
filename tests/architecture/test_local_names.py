"""Local variables and parameters are named by their content: a curve, a sentence, the rows of a case."""

from __future__ import annotations

import ast
import re

import pytest
from source import ROOT, by_folder, nodes

#: Words that say nothing about the content of a variable.
RIDDLES = ("found", "there", "told", "said", "held", "whole")
#: Further ones by package. `asked` is a keyword of `granchain.figure`.
MORE_RIDDLES = {"app": ("one", "least", "tell"), "granchain_core": ("asked", "way")}
#: Places where a script names a variable: a declaration, or a parameter of a function.
_DECLARED = re.compile(rf"""(?:\b(?:const|let)\s+|[(,]\s*)({'|'.join((*RIDDLES, *MORE_RIDDLES['app']))})\b
                           (?=\s*(?:=[^=]|of\b|,[^()]*\)\s*=>|\)\s*(?:=>|\{{)))""", re.VERBOSE)


@pytest.mark.parametrize("folder", [folder for package in MORE_RIDDLES
                                    for folder in by_folder(sorted((ROOT / package).rglob("*.py")))])
def test_python_names_its_variables_by_what_they_hold(folder: str) -> None:
    riddles = {*RIDDLES, *MORE_RIDDLES[folder.split("/")[0]]}
    faults = [f"{path.name}: {argument.arg}" for path in sorted((ROOT / folder).glob("*.py")) for node in nodes(path)
              if isinstance(node, (ast.FunctionDef, ast.Lambda)) for argument in ast.walk(node.args)
              if isinstance(argument, ast.arg) and argument.arg in riddles]
    faults += [f"{path.name}: {name.id}" for path in sorted((ROOT / folder).glob("*.py")) for node in nodes(path)
               if isinstance(node, ast.FunctionDef) for name in ast.walk(node)
               if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store) and name.id in riddles]
    assert faults == []


@pytest.mark.parametrize("folder", by_folder(sorted((ROOT / "app").rglob("*.js"))))
def test_scripts_name_their_variables_by_what_they_hold(folder: str) -> None:
    assert [(path.name, name) for path in sorted((ROOT / folder).glob("*.js"))
            for name in _DECLARED.findall(path.read_text(encoding="utf-8"))] == []


@pytest.mark.parametrize("script", ["const found = [];", "let one = 1;", "names.find((one) => hit)",
                                    "for (const one of all)", "push(there) {", "(one, i) => i"])
def test_a_script_with_such_a_name_is_noticed(script: str) -> None:
    assert _DECLARED.search(script)


@pytest.mark.parametrize("script", ["this.tell();", "attractors(one)", "// what was found (one, or none)",
                                    "rows.found = 3"])
def test_words_in_comments_and_members_are_no_variables(script: str) -> None:
    assert not _DECLARED.search(script)
