"""The largest forces that a run reports are those of its motion and do not depend on the sampling."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from granchain_core import State, run, scene

pytestmark = pytest.mark.quick

SCENES = {
    "sec2 340 Hz": scene("sec2"), "sec2 1130 Hz": scene("fig3b"), "rig 60 Hz": scene("rig"),
    "Tsuji": scene("sec2").evolve(dissipation="tsuji"),
    "precompressed": scene("sec2").evolve(dissipation="none", kappa=0.002, F0=5.0, f=900.0),
    "cut": scene("sec2").evolve(tension="cut"), "strongly damped": scene("sec2").evolve(D=400.0, f=500.0),
}
NAMES = ("max_input_force", "max_output_force", "max_output_force_elastic")


@functools.cache
def true(name: str) -> list[float]:
    """Return the largest forces over four periods, from 16384 samples per period and from the jumps.

    A smooth maximum is then known to (π/16384·10)²/2 = 2e-6. Maxima at jumps fall between the samples and come from
    dop853, which ends a step just after each jump.
    """
    result = run(SCENES[name].evolve(accuracy=1e-8), periods=0, record=4, samples=1 << 14, method="dop853")
    maxima = [result.jumps.of(c)[1].max(initial=0.0) for c in (0, result.scene.N)]
    return [max(result.input_force.max(), maxima[0]), max(result.output_force.max(), maxima[1]),
            result.output_force_elastic.max()]


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("samples", [1, 16, 96])
@pytest.mark.parametrize("method", ["dop853", "rk4-split"])
def test_largest_forces_are_found_between_the_samples(name, samples, method):
    """Input, output and elastic output force are within the stated error plus 2e-6, the error of the reference."""
    chain = SCENES[name].evolve(accuracy=1e-6 if method == "dop853" else 1e-4)
    result = run(chain, periods=0, record=4, samples=samples, method=method)
    found = [getattr(result, n) for n in NAMES]
    for value, exact, stated in zip(found, true(name), result.force_errors.row, strict=True):
        assert abs(value / exact - 1.0) < stated + 2e-6
        assert stated < 1e-3


def test_nothing_recorded_exceeds_the_reported_maximum():
    """The search for the maximum includes the recorded samples."""
    result = run(scene("sec2"), periods=3, record=3, samples=96)
    assert result.input_force.max() <= result.max_input_force
    assert result.output_force.max() <= result.max_output_force
    assert result.output_force_elastic.max() <= result.max_output_force_elastic * (1 + 1e-12)  # computed from SI values


def test_largest_forces_are_those_of_the_recorded_periods() -> None:
    """A chain is hit hard at the start, so the one discarded period has larger forces than the recorded ones."""
    hit = State(np.zeros(3), np.array([1.0, 0.0, 0.0]))
    chain = scene("sec2").evolve(N=3, accuracy=1e-3)
    whole = run(chain, periods=0, record=1, samples=256, start=hit)
    later = run(chain, periods=1, record=2, samples=256, start=hit)
    assert whole.max_output_force > 2.0 * later.output_force.max()
    assert later.max_output_force == pytest.approx(later.output_force.max(), rel=0.02)


def test_the_largest_elastic_force_is_the_walls() -> None:
    """The contact with a rigid wall is stiffer than one between beads. Its samples approach the maximum from below."""
    found = run(scene("sec2").evolve(N=3, wall="rigid", accuracy=1e-4), periods=2, record=3, samples=256)
    assert found.output_force_elastic.max() <= found.max_output_force_elastic * (1.0 + 1e-12)
    assert found.output_force_elastic.max() == pytest.approx(found.max_output_force_elastic, rel=1e-3)
