"""Maps, curves, batches and fits on the workers of a Dask scheduler: two processes on this machine, one of which is
killed.
"""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from distributed import Client, LocalCluster

from app.cli import main
from granchain_core import (
    BadInput,
    Cancelled,
    ComputationError,
    Stop,
    branch,
    fit,
    orbit,
    parameter_map,
    resonance_curve,
    run_many,
    scene,
)
from granchain_core.fitting import CurveTarget, Free, virtual_curve
from granchain_core.parameter_maps import Axis, Grid
from granchain_core.parameter_maps.cells import empty_cells
from granchain_core.parameter_maps.scheduled import CELLS_IN_TASK, iter_blocks
from granchain_core.scheduler import dealt, results

CHAIN = scene("sec2").evolve(N=2, f=2000.0)
#: Four tasks of cells that settle quickly.
WIDE = (("f", np.linspace(1600.0, 2600.0, 32)), ("A0", np.geomspace(2e-7, 2e-6, 32)))


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    with (LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
          Client(cluster) as one):
        yield one


def test_a_map_is_the_same_bytes_though_a_worker_is_killed_midway(client: Any) -> None:
    threaded = parameter_map(CHAIN, *WIDE)
    grid = Grid(CHAIN, *(Axis.of(*one) for one in WIDE))
    cells, left = empty_cells(grid), len(dealt(range(grid.size), CELLS_IN_TASK))
    victim = next(iter(client.run(os.getpid).values()))
    for rows in iter_blocks(client, grid, range(grid.size)):
        cells[rows["number"]] = rows
        if left == len(dealt(range(grid.size), CELLS_IN_TASK)):
            os.kill(victim, signal.SIGKILL)
        left -= 1
    assert left == 0 and victim not in client.run(os.getpid).values()
    assert cells.tobytes() == threaded.cells.tobytes()


def test_a_map_of_python_is_divided_among_the_workers(client: Any) -> None:
    """The argument is `scheduler=`, as for curves and fits; progress is reported after every block."""
    wide = (("f", np.linspace(1600.0, 2600.0, 20)), ("A0", np.geomspace(2e-7, 2e-6, 16)))
    parts: list[float] = []
    here, there = (parameter_map(CHAIN, *wide, progress=lambda _, part: parts.append(part), scheduler=one) for one in (None, client))
    assert there.cells.tobytes() == here.cells.tobytes() and there.complete
    assert len(parts) == 320 + len(dealt(range(320), CELLS_IN_TASK)) and parts[-1] == 1.0
    stop = Stop()
    stop.set()
    assert not parameter_map(CHAIN, *wide, stop=stop, scheduler=client).complete


def test_a_curve_is_the_same_and_a_sweep_cannot_be_divided(client: Any) -> None:
    frequencies = np.linspace(400.0, 1600.0, 80)  # more than one task
    here, there = (resonance_curve(scene("sec2"), frequencies, scheduler=one) for one in (None, client))
    for name in ("frequency", "max_output_force", "max_input_force", "max_output_force_elastic"):
        assert there.column(name).tobytes() == here.column(name).tobytes(), name
    assert [p.regime for p in there.points] == [p.regime for p in here.points]
    with pytest.raises(BadInput, match='cannot be divided among the workers of a scheduler; use start="rest"'):
        resonance_curve(scene("sec2"), frequencies, "up", scheduler=client)


def test_a_fit_evaluates_the_same_places(client: Any) -> None:
    measured = virtual_curve(CHAIN.evolve(D=120.0), [1800.0, 2000.0, 2200.0], 0.02, np.random.default_rng(1))
    here, there = (fit(CHAIN, CurveTarget(measured), [Free("D", 50.0, 200.0)], initial_points=8, scheduler=one) for one in (None, client))
    assert there.best == here.best and there.profiles == here.profiles
    assert (there.landscape[0] == here.landscape[0]).all() and (there.landscape[1] == here.landscape[1]).all()


def test_a_batch_of_orbits_starts_branches(client: Any) -> None:
    chains = [CHAIN.evolve(f=f) for f in (1900.0, 2000.0, 0.5)]
    found = run_many(chains, orbit, scheduler=client, period=1)
    assert [one is None for one in found] == [bool(sentence) for sentence in found.failures]
    alone = orbit(chains[1], 1)
    assert (found[1].state.displacement == alone.state.displacement).all()
    followed = branch(chains[1], "f", 2000.0, 2010.0, found[1].period, found[1].state)
    assert followed.half_branches[0].ended == "reached"
    assert list(found.to_pandas()["f"]) == [1900.0, 2000.0, 0.5]


def test_the_command_line_gives_a_curve_to_the_workers(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["curve", "sec2", "--set", "N=2", "--from", "1800", "--to", "2200", "--points", "5", "--json"]
    found = []
    for more in ([], ["--scheduler", client.scheduler.address]):
        assert main([*words, *more]) == 0
        found.append({**json.loads(capsys.readouterr().out), "wall_s": None})
    assert found[0] == found[1]
    assert Client.current() is client, "the command leaves its client open"


def fails(message: str) -> None:
    raise ValueError(message)


def test_a_failure_on_a_worker_is_one_sentence_and_a_stop_ends_the_work(client: Any) -> None:
    with pytest.raises(ComputationError, match="A worker could not do its part: ValueError: no disk; look at its log"):
        list(results(client, fails, [("no disk",)]))
    stop = Stop()
    stop.set()
    with pytest.raises(Cancelled):
        list(results(client, fails, [("never",)] * 3, stop))
