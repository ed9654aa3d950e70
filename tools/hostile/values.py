"""Values that no user means to enter: as text for command lines, and as JSON for messages."""

from __future__ import annotations

import random
from typing import Any

TEXTS = (
    "", " ", "nan", "NaN", "inf", "-inf", "Infinity", "-1", "0", "-0", "1e400", "-1e400", "1e-400", "1e308", "5e-324", "1_000",
    "１２", "٣", "①", "½", "0x10", "1,5", "1e5e5", "1.5.2", "+", "-", "--", "---", "None", "True", "null", "self", "cls", "__class__",
    "a" * 5000, "9" * 5000, "1" + "0" * 400, "0." + "0" * 400 + "1", "\n", "a\nb", "\r", "\t", "\x1b[31mred", "\x07", "é", "\u202eabc",
    "\u200b", "\udc80", "%s%n", "%d", "{0}", "{self}", "$(id)", "`id`", "; ls", "| cat", "&&", "../../nowhere/x", "/nowhere/x",
    "/proc/self/mem", "/", ".", "..", "~", "*", "?", "C:\\con", "file:///nowhere/x", "http://127.0.0.1:1/",
    "f=", "=f", "=", "f==3", "f=340=3", "N=1e9", "N=2.5", "N=-0", "N=" + "9" * 400, "wall=nowall", "wall=-1", "wall=nan",
    "self=1", "f=nan", "f=１２", "k=1e3,kappa=1", "dissipation=", "tension=maybe", "accuracy=0", "accuracy=1", "D=1e999", "F0=-1",
)


def text(rng: random.Random) -> str:
    """Return a text from the list, or random characters from all planes of Unicode."""
    if rng.random() < 0.8:
        return rng.choice(TEXTS)
    return "".join(chr(rng.choice((rng.randrange(1, 128), rng.randrange(128, 0xD800), rng.randrange(0xE000, 0x110000))))
                   for _ in range(rng.randrange(1, 20)))


def value(rng: random.Random, depth: int = 3) -> Any:
    """Return any value that JSON and Bokeh's own notation of numbers and objects can express."""
    kind = rng.randrange(11 if depth else 8)
    if kind < 3:
        return rng.choice((0, -1, 1, 1e15, -1e15, 1e308, 5e-324, 10**400, 0.5, 2**53, 2**63, True, False, None))
    if kind < 5:
        return {"type": "number", "value": rng.choice(("nan", "+inf", "-inf", "other", 5))}
    if kind < 8:
        return text(rng).encode(errors="replace").decode()[:2000]
    if kind == 8:
        return [value(rng, depth - 1) for _ in range(rng.randrange(4))]
    if kind == 9:
        return {"type": "map", "entries": [[value(rng, 0), value(rng, depth - 1)] for _ in range(rng.randrange(4))]}
    return rng.choice((
        {"id": "p999999"}, {"type": "object", "name": "CustomJS", "id": "x1"}, {"type": "object", "name": "os.system", "id": "x2"},
        {"type": "object", "name": "Nobody", "id": "x3", "attributes": {}}, {"type": "ndarray", "array": {"type": "bytes", "data": "AAAA"},
         "dtype": "float64", "shape": [10**9], "order": "little"}, {"type": "slice", "start": 0, "stop": -1, "step": 0},
        {"type": "symbol", "name": "x"}, {"type": "bytes", "data": "!"}, {"type": "nothing"}, {"type": "set", "entries": [[]]}))
