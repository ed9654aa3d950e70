"""Records at several drive frequencies with common parameters, and the correlation of the estimates."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from app.cli import main
from app.plots.fit import fit as drawn
from app.plots.theme import THEMES
from granchain_core import Amplitude, BadInput, Fit, Scene, Stop, fit, save, scene
from granchain_core.experiment import Series
from granchain_core.fitting import Free, RecordsTarget, SeriesTarget, per_frequency, virtual_series
from granchain_core.fitting.evaluation import Evaluation
from granchain_core.fitting.search import Target

CHAIN = scene("sec2").evolve(N=2, k=2e5)
ERROR = 0.02
#: Drive frequency [Hz] and amplitude [m] of each record.
DRIVES = {1800.0: 4.5e-7, 2200.0: 6e-7}
TRUTH = 115.0


def recorded(f: float, amplitude: float, seed: int) -> Series:
    """Record four periods of both forces, with noise."""
    return virtual_series(CHAIN.evolve(f=f, A0=amplitude, D=TRUTH), 4, 48, ERROR, np.random.default_rng(seed))


@pytest.fixture(scope="module")
def target() -> RecordsTarget:
    """Two records at different frequencies and amplitudes."""
    return RecordsTarget(tuple(SeriesTarget(recorded(f, a, i), ERROR, f) for i, (f, a) in enumerate(DRIVES.items())))


@pytest.fixture(scope="module")
def found(target: RecordsTarget) -> Fit:
    """A fit of one D, and an amplitude for each record."""
    free = per_frequency([Free("A0", 3e-7, 9e-7), Free("D", 60.0, 200.0)], target.frequencies)
    return fit(CHAIN, target, free, initial_points=32)


def test_common_and_own_parameters_are_recovered(found: Fit) -> None:
    assert [one.name for one in found.free] == ["A0@1800", "A0@2200", "D"] and found.verdict == "can"
    assert found.best == pytest.approx([*DRIVES.values(), TRUTH], rel=0.02)
    # each of three intervals contains the truth in 95 of 100 cases; three standard deviations are 1.53 times as far
    for one, true in zip(found.profiles, [*DRIVES.values(), TRUTH], strict=True):
        middle, half = 0.5 * (one.low + one.high), 0.5 * (one.high - one.low)
        assert abs(true - middle) < 3.0 / 1.96 * half


def test_two_records_narrow_the_intervals(found: Fit, target: RecordsTarget) -> None:
    alone = fit(CHAIN.evolve(A0=DRIVES[1800.0]), target.records[0], [Free("A0", 3e-7, 9e-7), Free("D", 60.0, 200.0)],
                initial_points=16)
    assert found.profiles[2].high - found.profiles[2].low < alone.profiles[1].high - alone.profiles[1].low


def test_a_record_is_computed_at_its_own_frequency_and_amplitude(target: RecordsTarget) -> None:
    """The scene's f and A0 are not used, and the residuals of both records follow one another."""
    amplitude = Amplitude.table(list(DRIVES), list(DRIVES.values()))
    both = target.evaluate(CHAIN.evolve(f=500.0, A0=1e-6, D=TRUTH), amplitude, None)
    for (one, place, regime), (f, a) in zip(target.parts(both), DRIVES.items(), strict=True):
        own = replace(one, frequency=None).evaluate(CHAIN.evolve(f=f, A0=a, D=TRUTH), None, None)
        assert regime == own.regimes[0] == "periodic1"
        assert both.residuals[place] == pytest.approx(own.residuals)
        assert (own.residuals**2).mean() == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / len(own.residuals)))


def test_a_datum_is_named_by_its_record_force_and_time(target: RecordsTarget) -> None:
    first = target.sizes[0]
    assert target.where(1) == f"in the input force at {target.records[0].time[1]:.6g} s of the record at 1800 Hz"
    assert target.where(2 * first - 1).startswith("in the output force at") and "2200 Hz" in target.where(2 * first - 1)


def test_records_are_in_tables_and_pictures(found: Fit, target: RecordsTarget, tmp_path: Path) -> None:
    table = {one.name: one for one in found.tables()}["data"]
    assert set(table.columns["frequency"].values) == set(DRIVES)
    assert len(table.columns["measured"].values) == len(found.evaluation.residuals) == sum(target.sizes)
    save(found, tmp_path / "fit.h5")
    titles = sorted(one.title.text for one in drawn(found, THEMES["light"]).select({"name": "data"}))
    assert titles[0].startswith("1800 Hz – χ²") and titles[1] == "2200 Hz"


@pytest.mark.parametrize(("records", "sentence"), [
    ((), "no record"),
    ((SeriesTarget(recorded(1800.0, 4.5e-7, 1), 0.1, 1800.0), SeriesTarget(recorded(1800.0, 4.5e-7, 1), 0.1)),
     "Record 2 of 2 has no drive frequency"),
    ((SeriesTarget(recorded(1800.0, 4.5e-7, 1), 0.1, 1800.0), SeriesTarget(recorded(1800.0, 4.5e-7, 1), None, 1900.0)),
     "Some of the records have an error"),
])
def test_records_that_cannot_be_compared_are_refused(records: tuple[SeriesTarget, ...], sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        RecordsTarget(records)


def test_the_command_fits_several_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = []
    for f, a in DRIVES.items():
        made = recorded(f, a, int(f))
        assert made.input_force is not None and made.output_force is not None
        file = tmp_path / f"{f:g}.csv"
        np.savetxt(file, np.column_stack([made.time, made.input_force, made.output_force]), delimiter=",",
                   header="time_s,input_force_N,output_force_N", comments="")
        words += ["--data", str(file), "--at", f"{f:g}"]
    free = ["--free", "A0=3e-7:9e-7", "--free", "D=60:200", "--error", str(ERROR), "--design", "16", "--no-intervals"]
    chain = ["sec2", "--set", "N=2", "--set", "k=2e5"]
    assert main(["fit", *chain, *words, *free, "--per-frequency"]) == 0
    said = capsys.readouterr().out
    assert "A0@1800" in said and "correlation of D and A0@2200" in said and "2200 Hz  χ²" in said
    assert main(["fit", *chain, *words[:-2], *free]) == 2
    assert "2 files are given with --data and 1 drive frequencies with --at" in capsys.readouterr().err


@dataclass(frozen=True, eq=False)
class Plane:
    """A target with residuals linear in D and k: `slopes` (R, 2) times their relative distances from 100 and 2e5."""

    slopes: np.ndarray
    smooth: bool = True
    sigma_known: bool = True
    error_freedom: int | None = None

    def where(self, datum: int) -> str:
        return str(datum)

    def evaluate(self, chain: Scene, amplitude: Amplitude | None, stop: Stop | None) -> Evaluation:
        part = np.array([chain.knobs["D"] / 100.0 - 1.0, chain.knobs["k"] / 2e5 - 1.0])
        return Evaluation(self.slopes @ part, 0.0, ("periodic",), self.slopes @ part)


@pytest.mark.parametrize("angle", [0.3, 1.2, 2.5])
def test_the_correlation_is_that_of_linear_least_squares(angle: float) -> None:
    """For two unit columns at an angle, the covariance (JᵀJ)⁻¹ has the correlation −J₁·J₂ of their directions."""
    slopes = 30.0 * np.array([[1.0, np.cos(angle)], [0.0, np.sin(angle)]])
    found = fit(CHAIN, cast(Target, Plane(slopes)), [Free("D", 50.0, 190.0), Free("k", 1e5, 3.5e5)], intervals=False)
    assert found.correlation is not None
    # derivatives are differences over 0.002 of bounds on a logarithmic scale
    assert found.correlation == pytest.approx(np.array([[1.0, -np.cos(angle)], [-np.cos(angle), 1.0]]), abs=0.01)


def test_parameters_that_do_the_same_have_no_correlation() -> None:
    found = fit(CHAIN, cast(Target, Plane(np.zeros((3, 2)))), [Free("D", 50.0, 190.0), Free("k", 1e5, 3.5e5)],
                intervals=False)
    assert found.correlation is None or np.isnan(found.correlation).all()
