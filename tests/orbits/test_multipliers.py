"""The derivative of the stroboscopic map agrees with monodromy.npz, which has finite differences in extended precision.

The derivatives in the file are in (u, v), and need no variational equations; granchain's are in (u, w). With v_i = w_i
+ (G_{i−1} − G_i)/m_i and B = ∂v/∂u at fixed w, they are the same map in different variables:

    M_uv = T(u_end) M_uw T(u_start)^{−1},    T = [[1, 0], [B, 1]].
"""

from __future__ import annotations

import importlib
import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from chains import recorded_scene
from scipy.optimize import linear_sum_assignment

from granchain_core import Scene, scene
from granchain_core.kernels.effects.contact import Chain
from granchain_core.kernels.effects.dissipation import LinearDashpot
from granchain_core.kernels.effects.driver import Harmonic
from granchain_core.kernels.effects.preload import Preload
from granchain_core.orbits.stroboscopic_map import StroboscopicMap

REFERENCE = Path(__file__).parents[1] / "reference"
_STORED = np.load(REFERENCE / "monodromy.npz")
CASES = sorted({key.split("/")[0] for key in _STORED})
_EXPONENT = {"linear": 0.0, "none": 0.0, "tsuji": 0.25, "kuwabara-kono": 0.5}


def shear(chain: Scene, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (v − w, T) at scaled displacements u and phase 0, for equal beads."""
    n, a = chain.N, _EXPONENT[chain.dissipation]
    rate = np.sqrt(chain.K * np.sqrt(chain.A0) / chain.bead(1).mass)
    strength = 0.0 if chain.dissipation == "none" else chain.D / (chain.bead(1).mass * rate)
    strength *= (chain.A0 / chain.reference_overlap) ** a
    static = chain.static_overlap() / chain.A0 if chain.F0 > 0 else np.zeros(n + 1)
    d = np.maximum(-np.diff(np.concatenate([[0.0], u, [0.0]])) + static, 0.0)
    primitive, slope = strength * d ** (a + 1) / (a + 1), strength * np.where(d > 0, d**a, 0.0)
    joins = np.vstack([np.zeros(n), np.eye(n)]) - np.vstack([np.eye(n), np.zeros(n)])  # ∂δ_c/∂u_i
    matrix = np.eye(2 * n)
    matrix[n:, :n] = -joins.T @ (slope[:, None] * joins)
    return -joins.T @ primitive, matrix


def product_map(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return end state and derivative of granchain's map in (u, v), from the stored start."""
    chain = recorded_scene(record(name)["scene"])
    start, n = _STORED[f"{name}/start"], chain.N
    before, first = shear(chain, start[:n])
    flow = StroboscopicMap(chain, record(name)["scene"]["periods"])(
        np.concatenate([start[:n], start[n:] - before]))
    after, last = shear(chain, flow.end[:n])
    end = np.concatenate([flow.end[:n], flow.end[n:] + after])
    return end, last @ np.linalg.solve(first.T, flow.derivative.T).T


def record(name: str) -> dict:
    """Return the record of a stored case."""
    return json.loads(str(_STORED[f"{name}/record"]))


def column_error(computed: np.ndarray, exact: np.ndarray) -> float:
    """Return the largest difference in any column, relative to the column's largest entry."""
    return float((np.abs(computed - exact).max(axis=0) / np.abs(exact).max(axis=0)).max())


def multiplier_error(computed: np.ndarray, exact: np.ndarray) -> float:
    """Return the largest distance between eigenvalues, paired one to one."""
    distance = np.abs(np.linalg.eigvals(computed)[:, None] - np.linalg.eigvals(exact)[None, :])
    return float(distance[linear_sum_assignment(distance)].max())


def test_the_file_has_the_cases_of_its_generator(monkeypatch: pytest.MonkeyPatch) -> None:
    """Generating the file again therefore adds no unused case and loses none."""
    monkeypatch.syspath_prepend(str(REFERENCE))
    generator = importlib.import_module("make_monodromy")
    assert sorted(case.scene.name for case in generator.stored_cases()) == CASES
    for case in generator.stored_cases():
        assert record(case.scene.name)["scene"] == asdict(case.scene)


@pytest.mark.parametrize("name", CASES)
def test_map_derivative_and_multipliers_agree_with_the_reference(name: str) -> None:
    end, derivative = product_map(name)
    exact, exact_end = _STORED[f"{name}/derivative"], _STORED[f"{name}/end"]
    # about 400 steps with errors of 1e-13, which the map amplifies by its derivative, a small number
    assert np.abs(end - exact_end).max() <= 1e-10 * np.abs(exact_end).max()
    # the stored differences are exact to a fiftieth of the change by extrapolation in their step, or better
    assert column_error(derivative, exact) <= max(1e-8, 0.02 * record(name)["columns"])
    assert multiplier_error(derivative, exact) <= 1e-7


def test_a_bead_that_meets_a_dashpot_has_the_closed_form_which_a_naive_tangent_misses() -> None:
    # One bead flies freely, then meets a wall that is only a dashpot 2ζ, at t* = −u/v; `rest` is the time after that.
    zeta, period, u, v = 0.2, 2.0, -0.7, 1.0
    damping, closing = 2.0 * zeta, -u / v
    rest = period - closing
    left = np.exp(-damping * rest)
    end = np.array([v * (1.0 - left) / damping, v * left])
    exact = np.array([[left, (1.0 - left) / damping + closing * left],
                      [-damping * left, left * (1.0 - damping * closing)]])
    # The (u, v) equations linearised on both sides of the closing, without the jump δv −= (D/m) δu at it.
    closed = np.array([[1.0, (1.0 - left) / damping], [0.0, left]])
    naive = closed @ np.array([[1.0, closing], [0.0, 1.0]])
    jump = np.array([[1.0, 0.0], [-damping, 1.0]])
    assert closed @ jump @ np.array([[1.0, closing], [0.0, 1.0]]) == pytest.approx(exact, abs=1e-14)

    flow = dashpot_wall(damping, period)(np.array([u, v]))
    derivative = np.array([[1.0, 0.0], [-damping, 1.0]]) @ flow.derivative  # w = v before the closing
    assert flow.end - [0.0, damping * flow.end[0]] == pytest.approx(end, abs=1e-12)
    assert derivative == pytest.approx(exact, abs=1e-10)
    assert flow.log_determinant == pytest.approx(-damping * rest, abs=1e-10)
    # Liouville's formula does not show the error, but the columns are wrong by 68 % and 20 % of their largest entries.
    assert np.linalg.det(naive) == pytest.approx(np.exp(flow.log_determinant), rel=1e-10)
    assert column_error(naive[:, 1:], exact[:, 1:]) == pytest.approx(0.1985, abs=1e-3)
    assert column_error(naive[:, :1], exact[:, :1]) == pytest.approx(0.6820, abs=1e-3)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_second_derivative_jumps_where_a_contact_closes_at_the_strobe(side: float) -> None:
    """u' = w − γu while the contact is closed, and u' = w before; the closing at −u/w is in the period if u < 0.

    ∂u_end/∂u is therefore e^{−γ(T + u/w)} for u < 0 and e^{−γT} for u > 0: continuous, and no contact grazes.
    """
    damping, period, w, u = 0.4, 2.0, 0.8, 1e-3
    at, beside = (dashpot_wall(damping, period)(np.array([side * fraction * u, w])).derivative[0, 0] for fraction in (1e-6, 1.0))
    slope = -damping * np.exp(-damping * period) / w if side < 0.0 else 0.0
    assert at == pytest.approx(np.exp(-damping * period), abs=1e-9)
    assert side * (beside - at) / u == pytest.approx(slope, abs=1e-3)


def dashpot_wall(damping: float, period: float) -> StroboscopicMap:
    """Return the map of one bead far from the driver whose contact with the wall at 0 has a dashpot but no spring."""
    stroboscopic_map = StroboscopicMap(scene("sec2").evolve(N=1, F0=0.5), 1)
    scaled, beta = stroboscopic_map.engine.scaled, 2.0 * np.pi / period
    slots = scaled.slots._replace(chain=Chain(scaled.slots.chain.inverse_mass, np.array([1.0, 0.0])),
                                  preload=Preload(np.array([-10.0, 0.0])),  # a negative one is a gap
                                  dissipation=LinearDashpot(damping), driver=Harmonic(1.0, beta))
    stroboscopic_map.engine.use(replace(scaled, slots=slots, beta=beta))
    return stroboscopic_map
