"""The checks can fail: if the core is broken on purpose, the rows that should notice it do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from granchain_core import ComputationError, Scene
from granchain_core.hard_cases import (
    Case,
    Measurement,
    contacts,
    damping,
    energy,
    extremes,
    long_runs,
    numbers,
    regimes,
    run_case,
    touches,
)
from granchain_core.integrate import checkpoint
from granchain_core.integrate import engine as engine_module
from granchain_core.integrate.scaling import ScaledChain
from granchain_core.kernels.effects.dissipation import LinearDashpot
from granchain_core.results.regime import Regime
from granchain_core.scene.state import State


def worst(measurements: list[Measurement]) -> Measurement:
    """Return the measurement furthest above its limit."""
    return max(measurements, key=lambda f: np.inf if not f.value <= f.limit else f.value - f.limit)


def failed(measurements: list[Measurement]) -> list[str]:
    """Return the names of the measurements above their limits."""
    return [f.name for f in measurements if not f.value <= f.limit]


def test_nan_is_above_every_limit() -> None:
    case = Case("x", "", "", "", lambda quick: [Measurement("nan", float("nan"), 1.0), Measurement("good", 0.5, 1.0)])
    assert [row.passed for row in run_case(case, True)] == [False, True]


def test_a_case_that_cannot_be_computed_is_a_row_that_did_not_pass() -> None:
    def refuse(quick: bool) -> list[Measurement]:
        raise ComputationError("bead 3", "not-finite")

    row, = run_case(Case("x", "", "", "", refuse), True)
    assert not row.passed and row.note == "bead 3"


def test_a_tolerance_that_is_too_loose_loses_energy(monkeypatch: pytest.MonkeyPatch) -> None:
    class Loose(energy.Bench):
        def __init__(self, *words: object, **names: object) -> None:
            super().__init__(*words, **{**names, "tolerance": 1e-8})  # type: ignore[arg-type]

    monkeypatch.setattr(energy, "Bench", Loose)
    assert "energy of the free chain after the impact" in failed(energy.free_chain(True))


def test_a_plain_dashpot_without_events_misses_its_restitution(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(damping, "bounce", lambda law, strength, cut, speed=1.0: damping.naive_bounce(strength, 200.0))
    assert len(failed(damping.restitutions(True))) == 5


def test_steps_over_brief_touches_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    real = touches.run

    def blind(cases: np.ndarray, driven: bool) -> np.ndarray:
        found = real(cases, driven)
        found[(cases[:, touches.DEPTH] > 0.0) & (cases[:, touches.DEPTH] < 2e-7), touches.CLOSINGS] = 0.0
        return found

    monkeypatch.setattr(touches, "run", blind)
    assert worst(contacts.brushed(True)).value > 0.0
    assert failed(contacts.brushed(True))


def test_a_checkpoint_rounded_to_si_and_back_is_another_run(monkeypatch: pytest.MonkeyPatch) -> None:
    def rounded(chosen, kept, stop=None):  # type: ignore[no-untyped-def]
        engine = checkpoint.resumed(chosen, kept, stop)
        engine.start(engine.state)
        return engine

    monkeypatch.setattr(long_runs, "resumed", rounded)
    assert long_runs.cut_and_gone_on("rk4", 20, 10) > 0.0


def test_a_clock_that_adds_its_steps_is_out_of_phase() -> None:
    naive = long_runs.long_runs_picture().traces[1].values
    assert naive[-1] > -8.0  # 1e-8 of an amplitude after 50,000 periods


def test_wrong_scaling_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The scaled damping gets a wrong, weak dependence on A0."""
    real = engine_module.scale_chain

    def wrong(chosen: Scene, *options: bool) -> ScaledChain:
        scaled = real(chosen, *options)
        damping = LinearDashpot(scaled.slots.dissipation.coefficient * (1.0 + 1e-6 * np.log(chosen.A0)))
        return replace(scaled, slots=scaled.slots._replace(dissipation=damping))

    monkeypatch.setattr(engine_module, "scale_chain", wrong)
    assert [name for name in failed(extremes.amplitudes(True)) if name.startswith("scaling")] == [
        "scaling from 1e-12 to 1e-4 m, fixed steps", "scaling from 1e-12 to 1e-4 m, adaptive"]


def test_a_change_per_period_in_place_of_the_distance_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def gullible(strobes: np.ndarray) -> Regime:
        change = float(np.abs(strobes[-1] - strobes[-2]).max() / np.abs(strobes).max())
        return Regime("periodic" if change < 1e-4 else "unsettled", 1, 0.5, change, len(strobes))

    monkeypatch.setattr(regimes, "find_period", gullible)
    made, wrong, slow = regimes.claims(100, 3)
    assert wrong > 0.1 * made
    assert slow > 0


def test_an_unnoticed_nan_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numbers.Injector, "outcome", lambda self: self.restore())
    count, wrong = numbers.injections(40)
    assert wrong == count


def test_an_asymmetric_chain_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    class Crooked(contacts.Bench):
        def __init__(self, beads: int, *words: object, **names: object) -> None:
            super().__init__(beads, *words, **{**names, "stiffness": [1.0 + 1e-9, *([1.0] * beads)]})  # type: ignore[arg-type]

    monkeypatch.setattr(contacts, "Bench", Crooked)
    assert contacts.mirrored(5, 200.0) > 1e-13


def test_a_drive_whose_impulse_is_not_counted_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    real = energy._segment

    def without_impulse(chosen: Scene, state: State, amplitude: float, samples: int) -> tuple[State, float, float]:
        after, _, largest = real(chosen, state, amplitude, samples)
        return after, 0.0, largest

    monkeypatch.setattr(energy, "_segment", without_impulse)
    assert failed(energy.switched_drives(True)) == ["after a jump", "ramp", "chirp", "stop"]
