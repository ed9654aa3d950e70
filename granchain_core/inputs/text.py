"""Parsing of numbers in text, the same for command line, links, fields of the page and CSV files.

Python's `float` and `int` accept more than a person means (`1_000`, `١٠`, `１`, `nan`), and `int` raises its own error
for 5,000 digits.
"""

from __future__ import annotations

import math
import re

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_WHOLE = re.compile(r"[+-]?[0-9]+")
#: Longest text that is read as a number [characters]: a double written out has at most about 770 digits; 25 are usual.
_LONGEST = 400


def number_in(text: str) -> float | None:
    """Return the finite number in a text (ASCII digits, decimal point, exponent); None for anything else."""
    plain = text.strip(" \t")
    if len(plain) > _LONGEST or not _NUMBER.fullmatch(plain):
        return None
    value = float(plain)
    return value if math.isfinite(value) else None


def whole_in(text: str) -> int | None:
    """Return the whole number in a text (ASCII digits alone); None for anything else."""
    plain = text.strip(" \t")
    return int(plain) if len(plain) <= _LONGEST and _WHOLE.fullmatch(plain) else None
