"""The table of mutants is in step with the core: what it changes is there, and what it names."""

from __future__ import annotations

from mutation.mutant import ROOT
from mutation.table import BROAD, DEMANDED, MUTANTS


def test_every_mutant_changes_what_it_says_and_remains_python() -> None:
    texts = {one.path: (ROOT / one.path).read_text(encoding="utf-8") for one in MUTANTS}
    for one in MUTANTS:
        changed = one.applied(texts[one.path])  # ValueError: the text is not there, or not so often
        assert changed != texts[one.path], one.name
        assert 1 <= one.which <= one.count, one.name
        compile(changed, one.path, "exec")


def test_names_are_unique_and_the_demanded_ones_are_there() -> None:
    names = [one.name for one in MUTANTS]
    assert len(set(names)) == len(names) >= 70
    assert len(DEMANDED) == 8
    assert {name for group in DEMANDED.values() for name in group} <= set(names)
    assert all(one.breaks for one in MUTANTS)


def test_the_tests_that_ought_to_notice_exist() -> None:
    for words in {BROAD, *(one.killers for one in MUTANTS), *(one.blind for one in MUTANTS)}:
        for word in words:
            if word.startswith("tests/"):
                file, _, name = word.partition("::")
                assert (ROOT / file).exists(), word
                function = name.partition("[")[0]
                assert f"def {function}" in (ROOT / file).read_text(encoding="utf-8") if name else True, word
