"""The scene `breather` is the left half of a chain that is driven at both ends, and agrees with a separate computation
of the whole chain.

The whole chain's equations, its Jacobian and Newton's method are implemented here with NumPy and SciPy only.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from granchain_core import branch, orbit, run, scene

CHAIN = scene("breather")
HALF, WHOLE = CHAIN.N, 2 * CHAIN.N + 1


class Whole(NamedTuple):
    """An orbit of the whole chain: amplitude of each bead [m], start, largest force in the middle [N], multipliers."""

    amplitude: np.ndarray
    start: np.ndarray
    force: float
    multipliers: np.ndarray


def slopes(t: float, y: np.ndarray) -> np.ndarray:
    """Return d/dt of displacements, velocities and 2·WHOLE tangents, in units of the static overlap and the period.

    All contacts stay closed: F = δ^{3/2} + c δ̇ with δ = 1 + u_j − u_{j+1}, and u_0 = −u_{N+1}.
    """
    n, shape = WHOLE, y.reshape(2 * WHOLE, -1)
    u, v, du, dv = shape[:n, 0], shape[n:, 0], shape[:n, 1:], shape[n:, 1:]
    overlap0 = CHAIN.static_overlap()[0]
    unit = CHAIN.K * np.sqrt(overlap0) / (CHAIN.masses()[0] * CHAIN.f**2)
    damping = CHAIN.D / (CHAIN.masses()[0] * CHAIN.f)
    a, angle = CHAIN.A0 / overlap0, 2.0 * np.pi * t
    ends = np.array([a * np.sin(angle), -a * np.sin(angle)]), 2.0 * np.pi * np.array([a * np.cos(angle), -a * np.cos(angle)])
    overlap = 1.0 - np.diff(np.concatenate([ends[0][:1], u, ends[0][1:]]))
    assert overlap.min() > 0.0
    rate = -np.diff(np.concatenate([ends[1][:1], v, ends[1][1:]]))
    force = unit * overlap**1.5 + damping * rate
    edge = np.zeros((1, du.shape[1]))
    change = (-1.5 * unit * np.sqrt(overlap)[:, None] * np.diff(np.vstack([edge, du, edge]), axis=0)
              - damping * np.diff(np.vstack([edge, dv, edge]), axis=0))
    return np.vstack([np.column_stack([v, dv]), np.column_stack([-np.diff(force), -np.diff(change, axis=0)])]).ravel()


def flow(x: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return states and tangents (times, 2·WHOLE, 1 + 2·WHOLE) from x at t = 0."""
    start = np.column_stack([x, np.eye(2 * WHOLE)]).ravel()
    solution = solve_ivp(slopes, (0.0, 1.0), start, "DOP853", times, rtol=1e-11, atol=1e-13)
    return solution.y.T.reshape(len(times), 2 * WHOLE, -1)


@functools.cache
def whole() -> Whole:
    """Find the whole chain's orbit by Newton's method, starting from the half chain's orbit and its mirror image."""
    start, overlap = orbit(CHAIN, 1).state, CHAIN.static_overlap()[0]
    u, v = start.displacement / overlap, start.velocity / (overlap * CHAIN.f)
    # shifted by 1e-4, differently on the two sides, so that Newton's method has something to do
    x = np.concatenate([u, [0.0], -u[::-1], v, [0.0], -v[::-1]]) + 1e-4 * np.sin(np.arange(2 * WHOLE))
    times = np.linspace(0.0, 1.0, 257)
    for _ in range(8):
        states = flow(x, times)
        left = states[-1, :, 0] - x
        if np.abs(left).max() < 1e-10:
            break
        x = x - np.linalg.solve(states[-1, :, 1:] - np.eye(2 * WHOLE), left)
    assert np.abs(left).max() < 1e-10
    positions = states[:, :WHOLE, 0]
    middle = 1.0 + positions[:, HALF - 1] - positions[:, HALF]
    return Whole(0.5 * overlap * np.ptp(positions, axis=0), x, float(CHAIN.F0 * middle.max() ** 1.5),
                 np.linalg.eigvals(states[-1, :, 1:]))


def test_the_whole_chain_has_the_same_motion_on_both_sides_of_a_bead_that_stands_still() -> None:
    breather = orbit(CHAIN, 1)
    ours = run(CHAIN.evolve(accuracy=1e-9), periods=0, record=1, samples=256, start=breather.state)
    amplitude = 0.5 * np.ptp(ours.displacement, axis=0)
    # SciPy's tolerance, over a period of a motion whose disturbances hardly grow
    assert whole().amplitude[:HALF] == pytest.approx(amplitude, rel=1e-7)
    assert whole().amplitude[HALF + 1:] == pytest.approx(amplitude[::-1], rel=1e-7)
    assert whole().amplitude[HALF] < 1e-7 * amplitude.max()
    assert whole().force == pytest.approx(float(ours.output_force_elastic.max()), rel=1e-7)


def test_its_multipliers_are_among_those_of_the_whole_chain() -> None:
    """The others are those of disturbances that are not mirror images, which the half chain cannot have. One pair of
    them grows, as docs/scenes.md says.
    """
    left = list(whole().multipliers)
    for mu in orbit(CHAIN, 1).multipliers:
        nearest = min(left, key=lambda other: abs(other - mu))
        assert nearest == pytest.approx(mu, abs=1e-7)
        left.remove(nearest)
    assert len(left) == 2 * WHOLE - 2 * HALF
    sizes = sorted(map(abs, left))
    assert sizes[-2:] == pytest.approx([1.00087, 1.00087], abs=5e-6) and sizes[-3] < 1.0


def test_bright_and_faint_states_coexist_between_two_folds() -> None:
    arm = branch(CHAIN, "A0", 1e-9, 1.2e-7, 1).half_branches[0]
    folds = [one.knob for one in arm.special if one.kind == "fold"]
    assert arm.ended == "reached" and folds == pytest.approx([95e-9, 74e-9], abs=1e-9)
    at = np.array([(point.knob, point.unstable_multipliers, point.max_output_force) for point in arm.points])
    between = at[(at[:, 0] > 75e-9) & (at[:, 0] < 94e-9)]
    stable = between[between[:, 1] == 0]
    assert np.ptp(stable[:, 2]) > 1.0  # [N]: two states that differ by more than a newton
    assert (between[:, 1] > 0).any()
