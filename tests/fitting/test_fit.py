"""Fits of virtual data: known parameters are found, their intervals contain them, and impossible fits are reported.

`python -m tools.fit_coverage` counts intervals over many draws; here, one draw of each kind has to pass.
"""

from __future__ import annotations

import json
import threading
from dataclasses import replace

import numpy as np
import pytest

from granchain_core import Amplitude, BadInput, Cancelled, Fit, Stop, fit, resonance_curve, scene, settle
from granchain_core.experiment import Feature, Measured, Series, read_data
from granchain_core.experiment.measured import VIRTUAL
from granchain_core.fitting import (
    CurveTarget,
    FeatureTarget,
    Free,
    SeriesTarget,
    per_frequency,
    virtual_curve,
    virtual_series,
)
from granchain_core.fitting.curve_target import SCATTER
from granchain_core.fitting.evaluation import FAILED
from granchain_core.fitting.feature_target import extrema
from granchain_core.fitting.parameters import free_of, stiffened, with_values
from granchain_core.fitting.search import Problem
from granchain_core.fitting.trains import Train
from granchain_core.runs.to_accuracy import run

CHAIN = scene("sec2").evolve(N=2, k=4e5)
FREQUENCIES = np.linspace(1000.0, 2600.0, 9)
TRUTH = {"A0": 5.4e-7, "D": 115.0, "k": 5e5}
FREE = [Free("A0", 2.5e-7, 1e-6), Free("D", 50.0, 200.0), Free("k", 1e5, 1.6e6)]


def measured(seed: int = 2, error: float = 0.03) -> Measured:
    """Return a virtual curve with the true parameters."""
    return virtual_curve(CHAIN.evolve(**TRUTH), FREQUENCIES, error, np.random.default_rng(seed))


@pytest.fixture(scope="module")
def found() -> Fit:
    """A fit of three parameters."""
    return fit(CHAIN, CurveTarget(measured()), FREE)


def test_a_fit_to_a_curve_recovers_its_parameters(found: Fit) -> None:
    for one, value, profile in zip(FREE, TRUTH.values(), found.profiles, strict=True):
        assert profile.low < value < profile.high, one.name
        assert one.low < profile.low and profile.high < one.high and not (profile.open_low or profile.open_high)
    assert found.verdict == "can" and found.degrees_of_freedom == 6 and found.probability is not None and found.probability > 0.01
    assert found.best[0] == found.scene.A0 and found.evaluation.residuals.shape == (9,)


def test_an_interval_ends_where_the_misfit_has_risen_by_3_84(found: Fit) -> None:
    """χ² with one degree of freedom is below 3.841 in 95 % of cases; the ends are found to 6 % of that."""
    for profile in found.profiles:
        places = np.array(profile.values)
        assert np.interp([profile.low, profile.high], places, profile.rises) == pytest.approx(3.841, rel=0.25)
        assert min(profile.rises) == 0.0


def test_a_result_is_plain_data(found: Fit) -> None:
    told = json.loads(json.dumps(found.to_json(), allow_nan=False))
    assert [one["name"] for one in told["parameters"]] == ["A0", "D", "k"] and told["verdict"] == "can"
    assert told["evaluations"] == len(found.landscape[1]) == len(found.landscape[0])
    assert found.landscape[1].min() == pytest.approx(found.misfit)


def test_a_fit_to_a_series_recovers_its_parameters() -> None:
    chain = CHAIN.evolve(f=1800.0, D=115.0)
    exact = virtual_series(chain, 1, 48, 0.0, np.random.default_rng(1))
    assert exact.input_force is not None
    error = 0.02 * float(exact.input_force.max())
    series = virtual_series(chain, 4, 48, error, np.random.default_rng(5))
    found = fit(CHAIN.evolve(f=1800.0), SeriesTarget(series, error), [Free("D", 60.0, 200.0)])
    assert found.profiles[0].low < 115.0 < found.profiles[0].high and found.verdict == "can"
    assert found.profiles[0].high - found.profiles[0].low < 10.0


def test_virtual_data_are_not_called_measured() -> None:
    series = virtual_series(CHAIN, 1, 48, 0.0, np.random.default_rng(1))
    assert measured().virtual and series.virtual and measured().word == series.word == VIRTUAL


def test_the_verdict_is_cannot_if_no_parameters_fit() -> None:
    """No resonance curve has forces that alternate from one frequency to the next, so the verdict is cannot."""
    given = measured(error=0.03)
    wrong = replace(given, force=given.force * np.where(np.arange(9) % 2, 1.5, 0.7))
    found = fit(CHAIN, CurveTarget(wrong), FREE[:2], intervals=False)
    assert found.verdict == "cannot" and found.probability is not None and found.probability < 1e-6
    assert "cannot describe the data within these bounds" in found.sentence and "standard deviations away at" in found.sentence


def test_without_errors_there_is_no_verdict_but_an_interval() -> None:
    given = replace(measured(), error=None)
    found = fit(CHAIN.evolve(A0=TRUTH["A0"], k=TRUTH["k"]), CurveTarget(given), [Free("D", 60.0, 200.0)])
    assert found.verdict == "not known" and "not known" in found.sentence and found.probability is None
    assert found.profiles[0].low < TRUTH["D"] < found.profiles[0].high and found.scale > 0.0


def test_an_amplitude_for_each_frequency_leans_on_its_prior() -> None:
    """As many amplitudes as forces can be found only with prior knowledge."""
    frequencies = np.array([1200.0, 1600.0, 2000.0])
    amplitudes = Amplitude.table(frequencies, [5e-7, 6e-7, 4.5e-7])
    curve = resonance_curve(CHAIN, frequencies, amplitude=amplitudes)
    given = Measured(frequencies, curve.column("max_output_force"), 0.02 * curve.column("max_output_force"), "")
    free = per_frequency([Free("A0", 3e-7, 9e-7, (5e-7, 1e-7)), Free("D", 60.0, 200.0)], frequencies)
    assert [one.name for one in free] == ["A0@1200", "A0@1600", "A0@2000", "D"]
    found = fit(CHAIN, CurveTarget(given), free, intervals=False)
    assert found.amplitude is not None and found.data == 6 and found.degrees_of_freedom == found.freedom == 2
    model = resonance_curve(found.scene, frequencies, amplitude=found.amplitude).column("max_output_force")
    assert model == pytest.approx(given.force, rel=0.04)


def test_a_chaotic_point_has_no_smaller_misfit() -> None:
    """A point that is not periodic has a wider distribution, but its misfit at the same value is not smaller."""
    irregular = scene("rig").evolve(A0=13e-6, f=100.0, kappa=0.001)  # chaotic, docs/paper.md
    curve = resonance_curve(irregular, [100.0])
    assert curve.points[0].regime.name != "periodic"
    force = curve.column("max_output_force")
    found = CurveTarget(Measured(np.array([100.0]), force, 0.01 * force, "")).evaluate(irregular, None, None)
    assert found.residuals == pytest.approx([0.0], abs=1e-9)
    assert found.log_variance == pytest.approx(2.0 * np.log(np.hypot(0.01, SCATTER) / 0.01))


def test_peaks_and_valleys_are_found_between_the_points() -> None:
    """Section 2's chain (docs/lecture.md) has peaks at 340 and 620 Hz among periodic points, and a valley at 470 Hz."""
    curve = resonance_curve(scene("sec2"), np.arange(200.0, 560.0, 10.0))
    assert min(abs(np.array(extrema(curve.points, True)) - 340.0)) < 10.0
    assert min(abs(np.array(extrema(curve.points, False)) - 470.0)) < 10.0
    feature = Feature(345.0, "1:1 resonance", 1, "")
    found = FeatureTarget([feature], np.arange(200.0, 560.0, 10.0), 3.0).evaluate(scene("sec2"), None, None)
    assert abs(found.residuals[0]) < 4.0 and abs(found.model[0] - 340.0) < 10.0
    nothing = FeatureTarget([feature], np.arange(2500.0, 2600.0, 20.0), 3.0).evaluate(scene("sec2"), None, None)
    assert abs(nothing.residuals[0]) > FAILED


@pytest.mark.parametrize("name", ["input_force", "output_force"])
def test_a_train_has_its_jumps_and_its_mean(name: str) -> None:
    """∫F dt over a period, the impulse, agrees with that from 256 times as many samples: a jump at a closing or a
    release that was smeared over one sample would cost 3e-4 to 4e-3. A narrow mean is the force itself.
    """
    chain = scene("sec2").evolve(N=2, f=2000.0, D=400.0)
    result, fine = (settle(chain, samples=samples).run for samples in (256, 65_536))
    train, contact = Train.of(result, name), 0 if name == "input_force" else 2
    closings = int((result.jumps.contact == contact).sum())
    assert closings == 1 and len(train.time) == len(result.time) + 4  # it closes once and opens once
    impulse = np.trapezoid(getattr(fine, name), fine.time)
    assert train.integral[-1] == pytest.approx(impulse, rel=5e-5)
    whole = train.mean_over(np.array([0.1e-3]), 3 * train.length)[0]
    assert whole == pytest.approx(impulse / train.length, rel=5e-5)
    narrow = train.mean_over(result.time[100:101] - result.time[0], 1e-9)[0]
    assert narrow == pytest.approx(getattr(result, name)[100], rel=1e-3, abs=1e-6)


def test_a_train_pulls_until_its_contact_opens() -> None:
    """The smallest force is D δ̇, just before the release, to the spacing of 65,536 samples. Laws whose force is zero
    there, and a tension cut, have no such jump.
    """
    chain = scene("sec2").evolve(N=2, f=2000.0)
    fine = settle(chain, samples=65_536).run
    train = Train.of(settle(chain, samples=256).run, "input_force")
    assert train.force.min() == pytest.approx(fine.input_force.min(), rel=2e-3)
    for other in ({"dissipation": "tsuji"}, {"tension": "cut"}):
        result = run(chain.evolve(**other), periods=20, record=1, samples=256)
        closings = int((result.jumps.contact == 0).sum())
        assert len(Train.of(result, "input_force").time) == len(result.time) + 2 * closings


def test_contacts_become_stiffer_and_nothing_else() -> None:
    harder = stiffened(CHAIN, 2.0)
    assert pytest.approx(2.0 * CHAIN.K) == harder.K and harder.k == CHAIN.k
    fitted, none = with_values(CHAIN, [Free("K", 1e9, 1e11), Free("D", 1, 100)], [1.5e10, 20.0])
    assert pytest.approx(1.5e10) == fitted.K and fitted.D == 20.0 and none is None


@pytest.mark.parametrize(("free", "sentence"), [
    ([], "1 to 30 different parameters"), ([Free("k", 1, 2), Free("kappa", 1e-3, 1e-2)], "of k and kappa only one"),
    ([Free("kappa", 1e-3, 1e-2), Free("A0@60", 1e-6, 1e-5)], "kappa = .* has no single value"),
    ([FREE[0], FREE[0]], "different"), (per_frequency(FREE, FREQUENCIES), "9 data and priors do not determine 11"),
])
def test_invalid_fits_are_refused(free: list[Free], sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        fit(CHAIN, CurveTarget(measured()), free)


@pytest.mark.parametrize(("words", "prior", "sentence"), [
    ("x=1:2", None, "Unknown parameter 'x'"), ("D=2:1", None, "first must be below"), ("D=1", None, "NAME=low:high"),
    ("A0=1:2", None, "outside"), ("D@60=1:2", None, "Unknown parameter"), ("K=0:1", None, "must be above 0"),
    ("D=1:2", "D=1:0", "must be above 0"), ("D=1:2", "D=1", "NAME=mean:sd"),
])
def test_a_malformed_parameter_is_refused(words: str, prior: str | None, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        free_of(words, prior)


def test_a_force_without_an_error_is_refused_and_one_of_zero_has_one() -> None:
    given = Measured(np.array([50.0, 60.0]), np.array([0.0, 2.0]), np.array([0.1, 0.0]), "")
    with pytest.raises(BadInput, match="error at 60 Hz is 0"):
        CurveTarget(given)
    assert CurveTarget(given, 0.05).sigma == pytest.approx([1e-4, 0.1])
    with pytest.raises(BadInput, match="All measured forces are 0"):
        CurveTarget(replace(given, force=np.zeros(2)), 0.05)


def test_repeats_give_the_standard_deviation_of_their_mean() -> None:
    """For two frequencies with two repeats each, 10 % and 20 % apart, the pooled value is √((0.1² + 0.2²)/2)/√2 of the
    mean.
    """
    given = read_data(b"f [Hz],F [N]\n50,0.95\n50,1.05\n60,1.8\n60,2.2\n")
    assert isinstance(given, Measured) and CurveTarget(given).sigma_known
    pooled = np.sqrt((0.1**2 / 2 + 0.2**2 / 2) / 2)
    assert CurveTarget(given).sigma == pytest.approx(pooled * np.array([1.0, 2.0]) / np.sqrt(2.0))


def test_a_series_without_forces_has_nothing_to_fit() -> None:
    with pytest.raises(BadInput, match="nothing to fit"):
        SeriesTarget(Series(np.arange(20.0), np.zeros(20), None, None, ""))


def test_a_fit_reports_progress_and_can_be_stopped() -> None:
    stop, told = Stop(), []

    def tell(count: int) -> None:
        told.append(count)
        if count == 5:
            threading.Thread(target=stop.set).start()

    with pytest.raises(Cancelled):
        fit(CHAIN, CurveTarget(measured()), FREE, stop=stop, progress=tell)
    assert told[:5] == [1, 2, 3, 4, 5] and len(told) < 60


def test_a_set_of_parameters_is_evaluated_once() -> None:
    problem = Problem(CHAIN, CurveTarget(measured()), FREE, Stop(), lambda _: None)
    first = problem.evaluate(np.full(3, 0.5))
    assert problem.evaluate(np.full(3, 0.5)) is first and len(problem.misfits) == 1
