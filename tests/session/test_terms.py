"""Terms on the page have definitions from the glossary, worded to be understood on their own."""

from __future__ import annotations

import re

from app.session.terms import SHOWN, definitions


def test_every_term_has_a_definition_without_marks() -> None:
    found = definitions()
    assert set(found) == set(SHOWN)
    for term, meaning in found.items():
        words = re.sub(r"\|[^|]+\||\[[Nm]\]", "", meaning)  # magnitudes and units are allowed
        assert len(meaning) > 20 and not {"`", "[", "|"} & set(words), term


def test_a_term_that_contains_another_comes_first() -> None:
    """The page uses the first match; otherwise, "anti-resonance" would be read as "anti-" and a resonance."""
    for place, term in enumerate(SHOWN):
        assert not any(term in later for later in SHOWN[place + 1:])
