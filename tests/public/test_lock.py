"""The lock files fit pyproject.toml and give a hash for every package, and the image installs nothing without one."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
WANTED = PROJECT["project"]["dependencies"]
LOCKS = {"requirements.lock": WANTED, "requirements-build.lock": PROJECT["build-system"]["requires"]}


def lines_of(lock: str) -> list[str]:
    """Return the lines of a lock file, one per package."""
    text = (ROOT / lock).read_text(encoding="utf-8").replace("\\\n", " ")
    return [line for line in text.splitlines() if not line.startswith("#")]


def numbers(version: str) -> tuple[int, ...]:
    """Return the numbers in a version."""
    return tuple(map(int, re.findall(r"\d+", version)))


@pytest.mark.parametrize("lock", LOCKS)
def test_every_line_is_an_exact_version_with_hashes(lock: str) -> None:
    for line in lines_of(lock):
        assert re.fullmatch(r"[a-z0-9._-]+==\S+(\s+--hash=sha256:[0-9a-f]{64})+", line), line[:60]


@pytest.mark.parametrize("lock", LOCKS)
def test_dependencies_of_pyproject_are_locked_within_their_bounds(lock: str) -> None:
    locked = dict(re.match(r"([a-z0-9._-]+)==(\S+)", line).groups() for line in lines_of(lock))  # type: ignore[union-attr]
    for wanted in LOCKS[lock]:
        name, least, most = re.match(r"([a-z0-9._-]+)>=([\d.]+)(?:,<([\d.]+))?", wanted).groups()  # type: ignore[union-attr]
        assert numbers(least) <= numbers(locked[name]), wanted
        assert most is None or numbers(locked[name]) < numbers(most), wanted


def test_the_image_installs_nothing_without_a_hash() -> None:
    docker = (ROOT / "Dockerfile").read_text(encoding="utf-8").replace("\\\n", " ")
    fetching = re.findall(r"\bpip (?:install|wheel) ([^&\n]+)", docker)
    assert len(fetching) == 4
    for options in fetching:
        assert "--require-hashes" in options or "--no-deps" in options, options
        assert "--no-build-isolation" in options or not options.rstrip().endswith(" ."), options


def test_bokeh_has_no_known_weakness_of_its_websocket() -> None:
    """CVE-2026-21883: before 3.8.2, Bokeh accepted any origin that merely started like an allowed one."""
    (bokeh,) = [wanted for wanted in WANTED if wanted.startswith("bokeh")]
    assert numbers(re.search(r">=([\d.]+)", bokeh)[1]) >= (3, 8, 2)  # type: ignore[index]
