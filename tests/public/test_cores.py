"""The number of threads and turns equals the number of processors that this process may use."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from granchain_core.execution import cores

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(("content", "allowed"), [
    ("max 100000\n", 4), ("200000 100000\n", 2), ("150000 100000\n", 2), ("50000 100000\n", 1),
    ("900000 100000\n", 4), ("1000 100000\n", 1), ("200000 0\n", 4), ("nonsense\n", 4), (None, 4)])
def test_a_quota_limits_the_processors(content: str | None, allowed: int, tmp_path: Path,
                                       monkeypatch: pytest.MonkeyPatch) -> None:
    """A container's quota file limits the four processors. A missing or unreadable file allows all of them."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: {0, 1, 2, 5}, raising=False)
    monkeypatch.setattr(cores, "_QUOTA", tmp_path / "cpu.max")
    if content is not None:
        (tmp_path / "cpu.max").write_text(content, encoding="ascii")
    assert cores.usable_cores() == allowed


def test_where_affinity_is_not_known_all_processors_count(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 3)
    monkeypatch.setattr(cores, "_QUOTA", tmp_path / "none")
    assert cores.usable_cores() == 3
