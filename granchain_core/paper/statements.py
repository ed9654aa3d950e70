"""The table of docs/paper.md: the paper's statements, our results, their differences, and commands that show them."""

from __future__ import annotations

import functools
import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass

from ..scene import ASSETS


@dataclass(frozen=True)
class Statement:
    """One row: the paper's words and ours, with computed entries in bold, **0.622** or **period 1**."""

    key: str
    figures: tuple[str, ...]
    paper: str
    ours: str
    differs: str
    command: str

    @property
    def computed(self) -> list[str]:
        """Return the bold numbers and words, in order."""
        return re.findall(r"\*\*(.+?)\*\*", self.ours)

    def wrong(self, numbers: Sequence[float | str]) -> list[str]:
        """Return the entries that differ from the computed ones in a word, or by more than the last digit."""
        if len(numbers) != len(self.computed):
            return [f"{self.key}: {len(numbers)} values for {len(self.computed)} in bold"]
        return [f"{self.key}: {text} is {value}" for text, value in zip(self.computed, numbers, strict=True)
                if not (text == value if isinstance(value, str) else abs(float(text) - value) <= unit_of(text))]


def unit_of(number: str) -> float:
    """Return one unit of the last digit: 0.001 for "0.622", 1e6 for "9.758e9"."""
    mantissa, _, exponent = number.lower().partition("e")
    return float(10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2])))


@functools.cache
def statements() -> tuple[Statement, ...]:
    """Return all rows in the order of the paper."""
    data = tomllib.loads((ASSETS / "paper" / "statements.toml").read_text(encoding="utf-8"))
    return tuple(Statement(**{**row, "figures": tuple(row["figures"])}) for row in data["statement"])
