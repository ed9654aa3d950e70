"""Kernels that are called without Numba's dispatcher get arguments of the types they were compiled for."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from granchain_core import branch, resonance_curve, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine
from granchain_core.integrate.batch import Batch
from granchain_core.integrate.methods import METHODS, RK4_SPLIT, MethodSetting
from granchain_core.kernels.compiling import entry
from granchain_core.kernels.samples import first_not_finite
from granchain_core.scene.state import State

#: Chains in one vector and in blocks, with an effect in every slot.
CHAINS = [{}, {"N": 2}, {"N": 40}, {"dissipation": "none"}, {"dissipation": "tsuji", "tension": "cut"},
          {"kappa": 0.5, "F0": 1.0}]


@pytest.fixture(autouse=True)
def checked(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Compare argument types at every call."""
    monkeypatch.setattr(entry, "CHECK_TYPES", True)
    yield


def advance(method: str, changes: dict, account: bool = False) -> None:
    chain = scene("sec2").evolve(f=2000.0, **changes)
    engine = Engine(chain, MethodSetting(method, tolerance=1e-6), 4, account)
    engine.start(State(np.zeros(chain.N), np.full(chain.N, 0.01)))
    engine.record(6)
    engine.record(2)
    engine.periods(2)
    assert np.isfinite(engine.maxima).all()


@pytest.mark.parametrize("method", METHODS)
def test_every_call_of_a_method_has_the_types_it_was_compiled_for(method: str) -> None:
    advance(method, {})


@pytest.mark.parametrize("changes", CHAINS, ids=str)
def test_every_call_for_a_kind_of_chain_has_the_types_it_was_compiled_for(changes: dict) -> None:
    advance(RK4_SPLIT, changes)
    advance(RK4_SPLIT, changes, account=True)


def test_a_workspace_of_another_type_has_a_specialization_of_its_own() -> None:
    """Tests may remove the vectors of a stepper that has already run with them."""
    engine = Engine(scene("sec2"), MethodSetting(RK4_SPLIT), 4)
    engine.record(2)
    engine.stepper.work = engine.stepper.work._replace(simd=None)
    assert np.isfinite(engine.record(2).force).all()


def test_every_call_for_curves_and_branches_has_the_types_it_was_compiled_for() -> None:
    chain = scene("sec2").evolve(N=2, f=2000.0)
    assert len(resonance_curve(chain, np.linspace(500.0, 3000.0, 12)).points) == 12
    assert branch(chain, "f", 1900.0, 2100.0, most_points=5).half_branches[0].points


def test_an_argument_of_another_type_is_refused() -> None:
    compiled = entry.entry(first_not_finite, np.zeros(8), 4)
    assert compiled(np.array([0.0, 0.0, np.nan, *[0.0] * 5]), 4) == 2
    with pytest.raises(TypeError, match="first_not_finite is called with"):
        compiled(np.zeros((8, 2))[:, 0], 4)


def test_a_batch_compares_the_types_of_the_kernel_that_it_calls_by_address() -> None:
    shown = scene("sec2")
    batch = Batch(shown, Stop())
    batch.put(0, batch.example, np.zeros(2 * (shown.N + 2)), 1, return_at=1)
    assert batch.run() == (0, True)
    batch._run = lambda *arguments: (0, 0)  # on its own it would notice the type as well
    work = batch.state.work
    batch.state = batch.state._replace(work=work._replace(limit=work.limit.astype(np.float32)))
    with pytest.raises(TypeError, match="begin_or_check_member is called with"):
        batch.run()


@pytest.mark.parametrize(("value", "checked"), [("1", True), ("0", False), ("", False), (None, False)])
def test_an_environment_variable_switches_the_checks_of_types_on(value: str | None, checked: bool) -> None:
    environment = {name: word for name, word in os.environ.items() if name != "GRANCHAIN_CHECK_TYPES"}
    if value is not None:
        environment["GRANCHAIN_CHECK_TYPES"] = value
    done = subprocess.run([sys.executable, "-c", "from granchain_core.kernels.compiling import entry; print(entry.CHECK_TYPES)"],
                          capture_output=True, text=True, env=environment, timeout=300, check=True)
    assert done.stdout.strip() == str(checked)


def test_the_key_contains_everything_that_determines_a_type() -> None:
    plain, tuples = np.zeros((2, 3)), (1.0, None)
    different = [plain, plain.T, plain[:, :2], plain[0], plain.astype(np.float32), tuples, (1, None), (1.0, 1.0),
                 [*tuples]]
    frozen = plain.copy()
    frozen.flags.writeable = False
    keys = [entry.types_of(value) for value in (*different, frozen)]
    assert len(set(keys)) == len(keys)
