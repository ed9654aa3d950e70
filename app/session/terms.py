"""Definitions of terms shown on the page, from docs/glossary.md."""

from __future__ import annotations

import re
from functools import cache

from granchain_core.scene.presets import ASSETS

#: The glossary, which is among the assets in an installed wheel.
FILE = next(path for path in (ASSETS / "glossary.md", ASSETS.parent / "docs" / "glossary.md") if path.is_file())
#: Glossary terms that the page's texts use, longest first, so that "anti-resonance" is not taken for "resonance".
SHOWN = ("quasi-periodic", "anti-resonance", "Floquet multiplier", "Lyapunov exponent", "sonic vacuum", "stop band",
         "stated error", "output force", "energy residual", "error control", "fixed-step method", "special point",
         "time step", "tangent flow", "attractor", "resonance",
         "multiplier", "transient", "observer", "preload", "overlap", "regime", "strobe",
         "dashpot", "kernel", "basin")
_ROW = re.compile(r"^\| [^|]+ \| ([^|]+) \| ((?:[^|\\]|\\.)+) \|", re.MULTILINE)


@cache
def definitions() -> dict[str, str]:
    """Return the definition of every shown term, as plain text."""
    rows: dict[str, str] = {}
    for terms, meaning in _ROW.findall(FILE.read_text(encoding="utf-8")):
        for name in _names(terms):
            rows.setdefault(name, _plain(meaning))  # the first row with the term counts
    return {term: rows[term] for term in SHOWN}


def _names(terms: str) -> list[str]:
    """Return the terms of a row: "resonance, anti-resonance of a curve" are two.

    Another name of a term is in parentheses after it; a "Floquet multiplier" is also a "multiplier".
    """
    names = [re.sub(r" of an? .*", "", word.strip()) for word in re.split("[(),]", terms) if word.strip()]
    if len(names) > 1 and names[-1].endswith(" force"):  # "input, output force"
        names = [word if word.endswith(" force") else f"{word} force" for word in names]
    return [*names, *(word.split()[-1] for word in names if word == "Floquet multiplier")]


def _plain(text: str) -> str:
    text = re.sub(r"\[([^\]]+)\]\([^)]*\)", r"\1", text.replace("\\|", "|").replace("`", ""))
    return re.sub(r"\s*\((?:model|design|regimes)\.md\)", "", text).strip()
