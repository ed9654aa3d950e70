"""The lock file fits pyproject.toml, and names the hash of everything."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LOCK = (ROOT / "requirements.lock").read_text(encoding="utf-8").replace("\\\n", " ")
LINES = [line for line in LOCK.splitlines() if not line.startswith("#")]
WANTED = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]


def numbers(version: str) -> tuple[int, ...]:
    """The numbers of a version."""
    return tuple(map(int, re.findall(r"\d+", version)))


def test_every_line_is_an_exact_version_with_hashes() -> None:
    for line in LINES:
        assert re.fullmatch(r"[a-z0-9._-]+==\S+(\s+--hash=sha256:[0-9a-f]{64})+", line), line[:60]


def test_what_pyproject_asks_for_is_locked_within_its_bounds() -> None:
    locked = dict(re.match(r"([a-z0-9._-]+)==(\S+)", line).groups() for line in LINES)  # type: ignore[union-attr]
    for wanted in WANTED:
        name, least, most = re.match(r"([a-z0-9._-]+)>=([\d.]+)(?:,<([\d.]+))?", wanted).groups()  # type: ignore[union-attr]
        assert numbers(least) <= numbers(locked[name]), wanted
        assert most is None or numbers(locked[name]) < numbers(most), wanted


def test_bokeh_has_no_known_weakness_of_its_websocket() -> None:
    """CVE-2026-21883: before 3.8.2 an origin that only began as an allowed one was let in."""
    (bokeh,) = [wanted for wanted in WANTED if wanted.startswith("bokeh")]
    assert numbers(re.search(r">=([\d.]+)", bokeh)[1]) >= (3, 8, 2)  # type: ignore[index]
