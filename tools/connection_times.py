"""The times in the script that watches the connection, `app/parts/inline_scripts/connection.js`."""

from __future__ import annotations

import re
from pathlib import Path

_SCRIPT = Path(__file__).resolve().parents[1] / "app" / "parts" / "inline_scripts" / "connection.js"


def connection_times() -> dict[str, tuple[int, str]]:
    """Return each time [ms] and what it is, by the name of its constant."""
    rows = re.findall(r"^ +(?:const )?([A-Z_]+) = (\d+)[,;] // (.+)$", _SCRIPT.read_text(encoding="utf-8"), re.MULTILINE)
    return {name: (int(value), words) for name, value, words in rows}


def retry_growth() -> float:
    """Return the factor by which each pause between two attempts to reach the server is longer than the one before."""
    growth = re.search(r"\bRETRY_GROWTH = ([\d.]+);", _SCRIPT.read_text(encoding="utf-8"))
    assert growth is not None, "RETRY_GROWTH in connection.js"
    return float(growth[1])
