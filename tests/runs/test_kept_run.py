"""A run that is interrupted anywhere and continues from its checkpoints is bit-identical to an uninterrupted run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from granchain_core import BadInput, Cancelled, Run, Stop, run, scene
from granchain_core.execution.checkpoints import folder_of
from granchain_core.runs.run_checkpoints import Reached, RunCheckpoints

CHOSEN = scene("sec2").evolve(N=5, f=1130.0)
PERIODS, RECORD, SAMPLES = 100, 3, 8


def kept_in(out: Path, resume: bool = False, method: str | None = None) -> RunCheckpoints:
    kept = RunCheckpoints(CHOSEN, PERIODS, RECORD, SAMPLES, method, out)
    kept.open(resume)
    return kept


def computed(kept: RunCheckpoints | None, method: str | None = None, stop: Stop | None = None) -> Run:
    return run(CHOSEN, PERIODS, RECORD, SAMPLES, method, kept=kept, stop=stop)


def assert_same(one: Run, other: Run) -> None:
    for name in ("displacement", "velocity", "force"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()
    for name in ("max_input_force", "max_output_force", "max_output_force_elastic", "displacement_error", "force_errors",
                 "energy_residual", "regime", "status"):
        assert getattr(one, name) == getattr(other, name), name
    assert one.jumps.force.tobytes() == other.jumps.force.tobytes()
    assert (one.cost.steps, one.cost.rhs, one.cost.events) == (other.cost.steps, other.cost.rhs, other.cost.events)


@pytest.mark.parametrize("method", [None, "dop853"])
@pytest.mark.parametrize("cut", [1, 30, 50, 77, 100])
def test_a_run_cut_anywhere_is_the_same_run(method: str | None, cut: int, tmp_path: Path,
                                            monkeypatch: pytest.MonkeyPatch) -> None:
    """Each computation writes 50 checkpoints. The run is stopped after checkpoint number `cut`, as if it were killed.
    """
    whole, stop, added = computed(None, method), Stop(), [0]
    add = RunCheckpoints.add

    def add_until(self: RunCheckpoints, reached: Reached) -> None:
        add(self, reached)
        added[0] += 1
        if added[0] == cut:
            self.folder.write()
            stop.set()

    monkeypatch.setattr(RunCheckpoints, "add", add_until)
    with pytest.raises(Cancelled):
        computed(kept_in(tmp_path / "a.h5", method=method), method, stop)
    monkeypatch.setattr(RunCheckpoints, "add", add)
    again = kept_in(tmp_path / "a.h5", resume=True, method=method)
    begun: list[int] = []
    begin = RunCheckpoints.begin

    def noted(self: RunCheckpoints, computation: int, engine: object) -> Reached | None:
        reached = begin(self, computation, engine)
        begun.append(reached.done if reached else 0)
        return reached

    monkeypatch.setattr(RunCheckpoints, "begin", noted)
    assert_same(computed(again, method), whole)
    assert begun[: (cut - 1) // 50 + 1] == [PERIODS] * ((cut - 1) // 50) + [2 * ((cut - 1) % 50 + 1)]
    again.folder.remove()
    assert not folder_of(tmp_path / "a.h5").exists()


def test_another_run_is_refused(tmp_path: Path) -> None:
    kept = kept_in(tmp_path / "a.h5")
    kept.folder.add({})
    kept.folder.write()
    with pytest.raises(BadInput, match="continue with --resume"):
        kept_in(tmp_path / "a.h5")
    with pytest.raises(BadInput, match="holds another run, sec2 with 100 \\+ 3 periods of 8 samples"):
        RunCheckpoints(CHOSEN, PERIODS, RECORD + 1, SAMPLES, None, tmp_path / "a.h5").open(True)
    assert np.isfinite(computed(kept_in(tmp_path / "a.h5", resume=True)).max_output_force)  # without checkpoints, it starts again
