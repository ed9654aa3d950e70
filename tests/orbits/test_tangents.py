"""The tangent flow by two routes, a missing saltation, which Liouville's formula does not show, and long chains."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from linear_chain import linear_multipliers

import granchain_core
from granchain_core import BadInput, Cancelled, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, dop853_setting
from granchain_core.kernels.error_control.orbit_record import OrbitRecord, record_orbit
from granchain_core.kernels.forces.peaks import PEAKS
from granchain_core.kernels.status import CANCELLED
from granchain_core.orbits import find_orbit, krylov
from granchain_core.orbits.orbit import sorted_multipliers
from granchain_core.orbits.stroboscopic_map import StroboscopicMap
from granchain_core.scene.state import rest


@pytest.mark.parametrize("changes", [{}, {"f": 1130.0}, {"kappa": 0.001}, {"F0": 0.5}, {"wall": "rigid", "N": 3},
                                     {"dissipation": "none", "N": 4}])
def test_tangents_in_w_and_tangents_in_v_with_saltation_are_one_derivative(changes: dict[str, object]) -> None:
    chain = scene("sec2").evolve(**changes)
    stroboscopic_map = StroboscopicMap(chain, 1)
    x = 0.3 * np.random.default_rng(3).standard_normal(2 * chain.N)
    first, second = stroboscopic_map(x).derivative, stroboscopic_map.derivative_by_saltation(x)
    assert len(stroboscopic_map.contact_events) > 0  # contacts must open and close, otherwise there are no jumps
    assert np.abs(first - second).max() < 1e-9 * np.abs(first).max()


def test_a_missing_saltation_shows_in_the_columns_and_not_in_the_determinant() -> None:
    chain = scene("sec2").evolve(N=3)
    stroboscopic_map = StroboscopicMap(chain, 1)
    x = 0.3 * np.random.default_rng(4).standard_normal(6)
    right = stroboscopic_map(x)
    wrong = stroboscopic_map.derivative_by_saltation(x, jumps=False)
    sign, logarithm = np.linalg.slogdet(wrong)
    assert sign > 0 and logarithm == pytest.approx(right.log_determinant, abs=1e-8)  # Liouville's formula does not show it
    assert np.abs(wrong - right.derivative).max() > 0.05 * np.abs(right.derivative).max()  # but the columns do
    step, difference = 1e-6, np.zeros((6, 6))
    for column, e in enumerate(step * np.eye(6)):
        difference[:, column] = (stroboscopic_map.end(x + e) - stroboscopic_map.end(x - e)) / (2 * step)
    # the central difference errs by step² and by the map's 1e-12/step
    assert np.abs(difference - right.derivative).max() < 3e-5 * np.abs(right.derivative).max()
    assert np.abs(difference - wrong).max() > 0.05 * np.abs(right.derivative).max()


def test_the_derivative_by_saltation_refuses_tsujis_law() -> None:
    stroboscopic_map = StroboscopicMap(scene("sec2").evolve(dissipation="tsuji"), 1)
    with pytest.raises(BadInput, match="no term for the change of the damping with the overlap"):
        stroboscopic_map.derivative_by_saltation(np.zeros(22))


def test_a_scene_that_cuts_tension_is_refused_in_one_sentence() -> None:
    with pytest.raises(BadInput, match="tension = allowed"):
        granchain_core.orbit(scene("sec2").evolve(tension="cut"), period=1)


@pytest.mark.parametrize("columns", [1, 8, 9])
def test_directions_are_products_with_the_derivative(columns: int) -> None:
    chain = scene("sec2").evolve(N=5)
    stroboscopic_map, rng = StroboscopicMap(chain, 1), np.random.default_rng(5)
    x, directions = 0.3 * rng.standard_normal(10), rng.standard_normal((10, columns))
    assert stroboscopic_map(x, directions=directions).derivative == pytest.approx(stroboscopic_map(x).derivative @ directions, abs=1e-12)


def test_the_flow_with_and_without_tangents_ends_at_the_same_place_with_the_same_events() -> None:
    stroboscopic_map = StroboscopicMap(scene("sec2"), 2)
    x = 0.3 * np.random.default_rng(6).standard_normal(22)
    flow = stroboscopic_map(x)
    assert np.array_equal(stroboscopic_map.end(x), flow.end)
    assert np.array_equal(stroboscopic_map.contact_events, flow.contact_events)
    assert np.all(np.diff(flow.contact_events[:, 1]) >= 0.0) and 0.0 <= flow.contact_events[-1, 1] <= 2.0
    closed: dict[int, bool] = {}
    for contact, _ in flow.contact_events:  # each contact opens and closes in turn
        c, closes = abs(int(contact)), contact > 0
        assert closed.get(c, not closes) is not closes
        closed[c] = closes


def test_a_long_chain_has_the_leading_multipliers_of_its_linear_modes() -> None:
    # as for the short chain, but only from products with single directions; the drive changes them by about A0/δ0
    chain = scene("sec2").evolve(N=200, F0=50.0, A0=1e-10, D=1000.0, f=2000.0)
    orbit = granchain_core.orbit(chain, period=1, start=rest(chain))
    assert orbit.residual <= 1e-9 and orbit.liouville_error is None
    exact = linear_multipliers(chain)[: len(orbit.multipliers)]
    assert np.abs(orbit.multipliers) == pytest.approx(np.abs(exact), rel=1e-4)


def test_krylov_and_dense_multipliers_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    dense = granchain_core.orbit(scene("sec2"), observer=True)
    monkeypatch.setattr(find_orbit, "MOST_BEADS_WITH_MULTIPLIERS", 5)
    monkeypatch.setattr(krylov, "leading_multipliers", partial(krylov.leading_multipliers, count=6))
    sparse = granchain_core.orbit(scene("sec2"), period=1, start=dense.state, observer=True)
    assert np.abs(sparse.multipliers) == pytest.approx(np.abs(dense.multipliers[:6]), abs=1e-8)
    assert dense.observer_multipliers is not None and sparse.observer_multipliers is not None
    assert np.abs(sparse.observer_multipliers) == pytest.approx(np.abs(dense.observer_multipliers[:6]), abs=1e-8)


def test_multipliers_of_any_matrix_are_sorted_by_modulus() -> None:
    sizes = np.abs(sorted_multipliers(np.random.default_rng(7).standard_normal((9, 9))))
    assert np.all(np.diff(sizes) <= 0.0)


def test_a_contact_that_rounding_closes_again_at_once_does_not_stop_the_flow() -> None:
    # After a release at t = 34.3 this contact closes again 5e-13 later; no step may become too small to move t.
    chain = scene("sec2").evolve(N=1, D=30.0, f=403.89217825350806)
    stroboscopic_map = StroboscopicMap(chain, 3)
    x = np.array([-0.05948783164245709, 0.15173847516946406])
    assert np.all(np.isfinite(stroboscopic_map.end(x)))
    assert stroboscopic_map.engine.counts.steps < 10_000


def test_the_stop_flag_ends_a_flow() -> None:
    stop = Stop()
    stroboscopic_map = StroboscopicMap(scene("sec2"), 1, stop)
    stop.set()
    with pytest.raises(Cancelled):
        stroboscopic_map.end(np.zeros(22))


def test_a_record_along_an_orbit_stops_within_its_period() -> None:
    stop = Stop()
    engine = Engine(scene("sec2"), dop853_setting(1e-9), 1, stop=stop)
    stop.set()
    record = OrbitRecord(np.zeros((64, 4)), np.zeros(PEAKS))
    status, _, _ = record_orbit(engine.stepper.method, engine.stepper.trajectory(engine.y), 1, record,
                                engine.counts.array, engine.stop.flag)
    assert (status, engine.counts.steps) == (CANCELLED, 0)
