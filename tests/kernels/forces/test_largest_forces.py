"""Force jumps of closing contacts, with every method and in every part of the program."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from granchain_core import Run, Scene, resonance_curve, run, scene, settle
from granchain_core.integrate import METHODS, Engine, MethodSetting, dop853_setting, fixed_step_setting
from granchain_core.integrate.methods import jump_errors
from granchain_core.parameter_maps import parameter_map
from granchain_core.scene.state import State

#: The methods that locate contact events.
LOCATING = [name for name, method in METHODS.items() if method.error_control or method.converges_regularly]
#: One bead that touches the driver as the driver starts at full speed: the first force on it is D A₀ 2πf, at t = 0+.
STRIKE = scene("sec2").evolve(N=1, D=400.0, f=500.0, accuracy=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_the_first_strike_of_the_driver_is_in_every_method(method: str) -> None:
    """The jump at t = 0+ has a closed form; methods that do not locate it find it from their first step, to 1e-3."""
    found = run(STRIKE, periods=0, record=1, samples=96, method=method)
    first = STRIKE.D * STRIKE.A0 * 2.0 * np.pi * STRIKE.f
    times, forces = found.jumps.of(0)
    assert times[0] == pytest.approx(0.0, abs=1e-6 * STRIKE.period)
    assert forces[0] == pytest.approx(first, rel=1e-9 if method in LOCATING else 1e-3)
    assert found.max_input_force >= forces.max()
    assert found.force[0, 0] == 0.0  # at t = 0 itself, no contact is compressed


@functools.cache
def ends() -> Run:
    """Run a strongly damped chain, whose output force is largest at a jump."""
    return run(scene("sec2").evolve(D=300.0, f=100.0, accuracy=1e-8), periods=2, record=2, samples=4096)


def test_jumps_stand_where_overlaps_are_zero_and_are_the_dashpots_force() -> None:
    """Overlap and velocity are interpolated linearly between the samples around a jump, to the accuracy of the spacing.
    """
    found = ends()
    spacing = found.time[1] - found.time[0]
    assert len(found.jumps.time) > 10 and found.jumps.missing == 0
    drive = 2.0 * np.pi * found.scene.f * found.scene.A0 * np.cos(2.0 * np.pi * found.scene.f * found.time)
    velocity = np.hstack([drive[:, None], found.velocity, np.zeros((len(found.time), 1))])
    for time, contact, force in zip(found.jumps.time, found.jumps.contact, found.jumps.force, strict=True):
        row = int((time - found.time[0]) / spacing)
        part = (time - found.time[row]) / spacing
        assert found.overlap[row, contact] <= 1e-12 * found.scene.A0 < found.overlap[row + 1, contact]
        rate = velocity[row : row + 2, contact] - velocity[row : row + 2, contact + 1]
        # the rate's slope jumps there by λ times the rate: interpolation is accurate to a part of λ φ spacing ≈ 0.03
        assert force == pytest.approx(found.scene.D * (rate[0] + part * (rate[1] - rate[0])), rel=0.03)


@pytest.mark.parametrize("beads", [19, 40])
def test_a_jump_is_read_where_the_overlap_vanishes(beads: int) -> None:
    """The cubic through a step's ends does not contain the kink at its root, and misses the closing by an order of h².

    Without a second look, the errors are 2.5e-5 to 2e-7 here. With it they are at most 2e-7, below the bound of
    `jump_errors`.
    """
    chain = scene("sec2").evolve(f=88.679, A0=1.60810e-8, D=211.888, k=2513.91, N=beads)
    on_its_way = Engine(chain, fixed_step_setting(), 1)
    on_its_way.periods(36)
    exact = jump_and_force(chain, dop853_setting(1e-11), on_its_way.state)[1]
    for refine in (4, 6, 8, 12, 16):
        least, force = jump_and_force(chain, fixed_step_setting(refine), on_its_way.state)
        assert abs(force / exact - 1.0) < least


def jump_and_force(chain: Scene, setting: MethodSetting, state: State) -> tuple[float, float]:
    """Return the lower limit of the relative error stated for the largest input force, at a jump, and the scaled force.
    """
    engine = Engine(chain, setting, 1)
    engine.start(state)
    engine.reset_peaks()
    maxima = engine.advance_and_find_largest(1)
    assert engine.jumps[0] == maxima[0]
    return jump_errors(setting, engine.scaled, setting.step(engine.scaled, 1), engine.jumps, maxima)[0], maxima[0]


def test_the_largest_force_is_that_of_a_jump() -> None:
    found = ends()
    top = found.jumps.of(found.scene.N)[1].max()
    assert found.max_output_force == pytest.approx(top, rel=1e-12)  # scaled and back
    assert top > 1.0001 * found.output_force.max()


@pytest.mark.parametrize("law", ["tsuji", "kuwabara-kono", "none"])
def test_laws_without_a_jump_have_none(law: str) -> None:
    assert len(run(STRIKE.evolve(dissipation=law), periods=0, record=1).jumps.time) == 0


#: Largest output force [N] of section 2's chain with D = 300 N s/m at 100 Hz, as tests/numerics/forces/located.py
#: computes it in (u, v) with located events.
TRUTH = 0.1473283


def test_every_part_of_the_program_gives_the_same_largest_force() -> None:
    """A run, curves from rest and upward, a parameter map and a settled picture agree to five digits, and with the
    truth to their stated errors.
    """
    chain = scene("sec2").evolve(D=300.0, f=100.0)
    points = [resonance_curve(chain, [100.0, 101.0], start=start).points[0] for start in ("rest", "up")]
    cell = parameter_map(chain, ("f", [100.0, 101.0]), ("A0", [chain.A0])).cells[0]
    passed = run(chain, periods=30, record=1)
    picture = settle(chain).run
    found = [(p.max_output_force, p.force_errors.output) for p in points]
    found += [(float(cell["max_output_force"]), float(cell["error_estimate"])), (passed.max_output_force, passed.force_errors.output),
              (picture.max_output_force, picture.force_errors.output)]
    for force, stated in found:
        assert f"{force:.5f}" == "0.14733"
        assert abs(force / TRUTH - 1.0) < stated + 1e-6 < 1e-3


def test_a_long_chain_sees_the_jumps_at_its_ends() -> None:
    """A chain of 40 beads is integrated in blocks of eight, which leave steps with events to the scalar method. Its
    forces agree with dop853 to the stated errors.
    """
    chain = scene("sec2").evolve(N=40, D=300.0, f=400.0, accuracy=1e-6)
    long = resonance_curve(chain, [400.0], start="up").points[0]
    assert long.regime.period is not None
    exact = run(chain, periods=0, record=long.regime.period, method="dop853", start=long.state)
    for force, stated, true in zip(
            (long.max_input_force, long.max_output_force, long.max_output_force_elastic), long.force_errors.row,
            (exact.max_input_force, exact.max_output_force, exact.max_output_force_elastic), strict=True):
        assert abs(force / true - 1.0) < stated < 2e-3  # of which 1/(1 − |μ|) is a part


#: Distance of a bead that is just touched from the driver's turning point, in drive amplitudes.
NEAR = 2e-3


@pytest.mark.parametrize("method", METHODS)
def test_touches_shorter_than_a_step_are_found_or_said_not_to_be_resolved(method: str) -> None:
    """The drive is so fast that a period has 17 steps: the touch lasts a third of a step, and lies between two samples.

    The bead is at A (1 − NEAR) in front of a soft wall, and A sin θ passes it at the rate A β √(1 − (1 − NEAR)²). Until
    then, the wall moves it by a hundredth of NEAR. If the touch is not resolved, its overlap is approximated by two
    parabolas, to 10 %.
    """
    chain, resolves = scene("sec2").evolve(N=1, f=20_000.0, wall=1e-3), method in LOCATING
    engine = Engine(chain, MethodSetting(method, tolerance=1e-9), 17)
    engine.start(State(np.array([chain.A0 * (1.0 - NEAR)]), np.zeros(1)))
    engine.record(8)
    touched = engine.closings[engine.closings[:, 2] == 0]
    assert len(touched) == 1
    assert (engine.unresolved == 0) is resolves
    rate = engine.scaled.beta * np.sqrt(1.0 - (1.0 - NEAR) ** 2)
    expected = engine.scaled.slots.dissipation.coefficient * rate
    assert touched[0, 3] == pytest.approx(expected, rel=0.02 if resolves else 0.1)
    assert engine.maxima[0] >= touched[0, 3]
