"""Long chains in batches take no more memory than there is: fewer threads compute them, or they are refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from granchain_core import resonance_curve, scene
from granchain_core.errors import BadInput
from granchain_core.execution import memory
from granchain_core.execution.stop import Stop
from granchain_core.integrate.batch import Batch, batch_bytes
from granchain_core.steady.batch import starts

LONG = scene("sec2").evolve(N=1000)


def test_the_strobes_are_nearly_all_that_a_batch_of_long_chains_takes() -> None:
    state = Batch(LONG, Stop()).state
    arrays = [array for part in state for array in (part if isinstance(part, tuple) else (part,))]
    total = sum(one.nbytes for array in arrays for one in (array if isinstance(array, tuple) else (array,)))
    assert state.record.strobes.nbytes == batch_bytes(LONG.N)
    assert batch_bytes(LONG.N) <= total < 1.05 * batch_bytes(LONG.N)


def test_only_as_many_threads_as_have_memory_for_a_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(starts, "usable_memory", lambda: 4 * batch_bytes(LONG.N))
    assert starts.threads_for(LONG, 8) == 3  # 0.8 of the memory
    assert starts.threads_for(LONG, 2) == 2
    assert starts.threads_for(LONG.evolve(tension="cut"), 8) == 8  # settled without batches
    monkeypatch.setattr(starts, "usable_memory", lambda: None)
    assert starts.threads_for(LONG, 8) == 8


def test_a_batch_larger_than_the_memory_is_refused_with_the_longest_chain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(starts, "usable_memory", lambda: batch_bytes(LONG.N))
    with pytest.raises(BadInput, match=r"nearest valid value is N = 799\.") as caught:
        resonance_curve(LONG, [1000.0])
    assert "are too small for one" in str(caught.value)
    assert starts.threads_for(LONG.evolve(N=799), 1) == 1
    with pytest.raises(BadInput):
        starts.threads_for(LONG.evolve(N=800), 1)


def test_the_limits_of_a_container_and_of_a_service_are_read(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    own = tmp_path / "cgroup"
    own.write_text("0::/system.slice/granchain.service\n")
    monkeypatch.setattr(memory, "_GROUPS", tmp_path)
    monkeypatch.setattr(memory, "_OWN_GROUP", own)
    physical = memory.usable_memory()
    (tmp_path / "memory.max").write_text("1000000\n")
    assert memory.usable_memory() == 1_000_000
    (tmp_path / "system.slice" / "granchain.service").mkdir(parents=True)
    (tmp_path / "system.slice" / "granchain.service" / "memory.max").write_text("2000\n")
    assert memory.usable_memory() == 2000
    for limit in (tmp_path / "memory.max", tmp_path / "system.slice" / "granchain.service" / "memory.max"):
        limit.write_text("max\n")
    assert memory.usable_memory() == physical
