"""Of a long impact, the slow beads behind the pulse cannot be computed to the requested accuracy, but the pulse can."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.cli.forces import warn
from granchain_core import run, scene
from granchain_core.integrate import Engine, MethodSetting, method_for
from granchain_core.scene.state import rest

SAMPLES = 500


@pytest.mark.long
def test_two_fine_computations_disagree_behind_the_pulse_only() -> None:
    """The numbers are those of docs/hard-cases.md, "Slow beads behind an impact"."""
    shown = scene("impact").evolve(N=500, f=20.0)
    setting = method_for(1e-6, False)
    found = []
    for refine in (32.0, 64.0):
        engine = Engine(shown, MethodSetting(setting.method, refine * setting.refine), SAMPLES)
        engine.start(rest(shown))
        found.append(engine.record(SAMPLES))
    one, other = found
    length, speed = np.abs(other.displacement).max(), np.abs(other.velocity).max()
    difference = np.abs(one.displacement - other.displacement).max(axis=0) / length
    assert 1e-7 < difference[:60].max() < 1e-4 and difference.argmax() < 60
    assert difference[100:].max() < 2e-8
    np.testing.assert_allclose(one.force.max(axis=0), other.force.max(axis=0), rtol=2e-8)
    # halfway, the beads behind the pulse are nearly in contact and nearly at rest
    middle = SAMPLES // 2
    gaps = np.diff(other.displacement[middle])[[29, 39, 49, 59]] / length
    assert (gaps > 0.0).all() and gaps[0] > 1e-3 and gaps[-1] < 1e-7
    assert np.abs(other.velocity[middle, 74:95]).max() < 1e-11 * speed


def test_a_run_says_that_its_forces_are_as_accurate_as_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    short = run(scene("sec2").evolve(N=2, f=2000.0), periods=0, record=1, samples=8)
    found = replace(short, status="accuracy-not-reached", displacement_error=3e-5)
    largest = max(found.force_errors.row)
    assert largest <= found.scene.accuracy
    warn(found, 1.0)
    assert f"may be 3.0e-05 of the largest displacement. The largest forces reached it, with {largest:.1e}." \
        in capsys.readouterr().err
    warn(replace(found, scene=found.scene.evolve(accuracy=0.5 * largest)), 1.0)
    assert "largest forces" not in capsys.readouterr().err
