"""Every result as a dataset, a data frame, a file and a notebook cell: all have the same names, units and numbers."""

from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import xarray

import granchain_core
from granchain_core import BadInput, Stop, run_many, save, scene, settle
from granchain_core.experiment import Feature
from granchain_core.fitting import CurveTarget, FeatureTarget, Free, SeriesTarget, virtual_curve, virtual_series
from granchain_core.former_names import present
from granchain_core.tables import Labelled

CHAIN = scene("sec2").evolve(N=2, f=2000.0)
TIME = np.linspace(0.0, 1e-3, 65)
FREE = [Free("D", 60.0, 200.0)]


def _fit(target: Any, intervals: bool = False) -> Labelled:
    return granchain_core.fit(CHAIN, target, FREE, initial_points=2, intervals=intervals)


def _measured() -> Any:
    return virtual_curve(CHAIN, [1800.0, 2000.0, 2200.0], 0.02, np.random.default_rng(1))


#: A small example of every result that a public function returns. Each key starts with the name of its class.
RESULTS = {
    "Run": lambda: granchain_core.run(CHAIN, periods=10, record=1, samples=16),
    "Settled": lambda: settle(CHAIN, samples=16),
    "Runs": lambda: run_many([CHAIN, CHAIN.evolve(wall="rigid"), CHAIN.evolve(N=3)], settle, samples=16),
    "Curve": lambda: granchain_core.resonance_curve(CHAIN, [1800.0, 2000.0]),
    "Curve driven": lambda: granchain_core.resonance_curve(
        CHAIN, [1800.0, 2000.0], amplitude=granchain_core.Amplitude("constant-velocity", (6e-3,))),
    "Orbit": lambda: granchain_core.orbit(CHAIN, observer=True),
    "Branch": lambda: granchain_core.branch(CHAIN, "f", 2000.0, 2020.0),
    "ParameterMap": lambda: granchain_core.parameter_map(CHAIN, ("f", [1900.0, 2000.0, 2100.0]), ("A0", [4e-7, 5e-7])),
    "Observation": lambda: granchain_core.observe(CHAIN, TIME, np.sin(np.pi * TIME / 1e-3) ** 2, np.zeros(65)),
    "WorkPrecision": lambda: granchain_core.WorkPrecision(CHAIN, "dop853", "SciPy's DOP853", 1e-12, [
        granchain_core.accuracy.Row("rk4", "2 steps", 1e-5, 0.001, 7, 2.0),
        granchain_core.accuracy.Row("verlet", "1 step", np.nan, np.nan, 0, 1.0, "It took too long.")]),
    "Fit": lambda: _fit(CurveTarget(_measured()), intervals=True),
    "Fit of a series": lambda: _fit(SeriesTarget(virtual_series(CHAIN, 2, 32, 0.05, np.random.default_rng(1)), 0.05)),
    "Fit of features": lambda: _fit(FeatureTarget([Feature(1500.0, "1:1 resonance", 1, "")], np.linspace(800.0, 2400.0, 5), 50.0)),
    "Spectrum": lambda: granchain_core.spectrum(settle(CHAIN).run),
    "Transfer": lambda: granchain_core.transfer(settle(CHAIN).run),
    "RotationNumber": lambda: granchain_core.rotation_number(CHAIN),
    "RotationNumber decided": lambda: granchain_core.rotation_number(scene("sec2").evolve(f=1700.0), 2000),
    "LyapunovSpectrum": lambda: granchain_core.lyapunov_spectrum(CHAIN, periods=20),
    "BifurcationDiagram": lambda: granchain_core.bifurcation_diagram(CHAIN, "f", [1900.0, 2000.0], keep=4),
    "Basins": lambda: granchain_core.basins(CHAIN, ("u1", [0.0, 1e-7, 2e-7]), ("v1", [0.0, 1e-3])),
    "Attractors": lambda: granchain_core.attractors(CHAIN, random_states=2),
    "Driven": lambda: granchain_core.drive(CHAIN, granchain_core.Signal.burst(CHAIN.A0, 2000.0, 2, 0.002)),
    "Pulse": lambda: granchain_core.pulse(granchain_core.run(
        scene("sec2").evolve(N=5, f=800.0, drive="rest", strike=0.01), periods=0, record=1, samples=500)),
}


@cache
def result(kind: str) -> Labelled:
    """Return a result of this kind, computed once."""
    import granchain_core.accuracy  # noqa: F401  (its rows)

    return RESULTS[kind]()  # type: ignore[no-any-return]


def test_every_public_class_with_numbers_has_tables() -> None:
    classes = {name for name in granchain_core.__all__ if present(name) == name and isinstance(getattr(granchain_core, name), type) and
               issubclass(getattr(granchain_core, name), Labelled)}
    assert classes == {kind.split()[0] for kind in RESULTS}


@pytest.mark.parametrize("kind", RESULTS)
def test_print_shows_the_summary_and_no_array(kind: str) -> None:
    shown = repr(result(kind)).splitlines()
    assert shown == [result(kind).heading(), *(f"  {line}" for line in result(kind).summary())]


#: Headings state the knobs that differ from the preset, but not those that the result varies.
HEADINGS = {
    "Run": "Run of sec2: f = 2000 Hz, N = 2", "Curve": "Curve of sec2: N = 2", "Branch": "Branch of sec2: N = 2",
    "ParameterMap": "ParameterMap of sec2: N = 2", "BifurcationDiagram": "BifurcationDiagram of sec2: N = 2",
    "Pulse": "Pulse of sec2: time 1/f = 0.00125 s, N = 5, drive = rest, strike = 0.01 m/s",
}


@pytest.mark.parametrize("kind", HEADINGS)
def test_a_heading_states_no_value_that_was_not_used(kind: str) -> None:
    assert result(kind).heading() == HEADINGS[kind]


def test_the_heading_of_a_fit_states_the_frequency_of_a_series_only() -> None:
    assert "f = " not in result("Fit of features").heading() and "f = " not in result("Fit").heading()
    assert result("Fit of a series").heading().startswith("Fit of sec2: f = 2000 Hz, ")


@pytest.mark.parametrize("kind", RESULTS)
def test_a_file_opens_in_xarray_as_to_xarray_gives_it(kind: str, tmp_path: Path) -> None:
    """Names, axes, units, long names and numbers of each table agree, and the root has the same attributes."""
    found = result(kind)
    file = save(found, tmp_path / "a.h5")
    for table in found.tables():
        made = found.to_xarray(table.name)
        for name, variable in made.variables.items():
            assert set(variable.attrs) >= {"units", "long_name"} and variable.attrs["long_name"], name
        with xarray.open_dataset(file, engine="h5netcdf", group=table.name) as opened:
            xarray.testing.assert_identical(opened.load(), made.assign_attrs({}).drop_attrs(deep=False))
    with xarray.open_dataset(file, engine="h5netcdf") as root:
        told = made.attrs
        assert {**root.attrs, "created": ""} == pytest.approx({**told, "granchain_schema": 1, "created": ""}, nan_ok=True)
    made.to_netcdf(tmp_path / "b.nc", engine="h5netcdf")  # other programs can write it again


@pytest.mark.parametrize("kind", RESULTS)
def test_a_data_frame_has_the_same_numbers_with_units(kind: str) -> None:
    found = result(kind)
    for table in found.tables():
        frame, data = found.to_pandas(table.name), found.to_xarray(table.name)
        assert tuple(frame.index.names) == table.rows
        assert set(frame.attrs["units"]) == {*frame.columns, *table.rows} and frame.attrs["machine"]
        for name in set(frame.columns) & set(data.data_vars):
            if data[name].dims == table.rows and data[name].dtype.kind == "f":
                assert np.array_equal(frame[name].to_numpy(), data[name].values.ravel(), equal_nan=True), name


def test_a_frame_has_a_column_for_each_bead_and_words_for_regimes() -> None:
    run = result("Run").to_pandas()
    assert {"displacement_1", "displacement_2", "force_0", "force_2"} <= set(run.columns)
    assert run.attrs["units"]["velocity_2"] == "m/s" and run.index.name == "time"
    assert (run["displacement_2"] == result("Run").displacement[:, 1]).all()  # type: ignore[attr-defined]
    cells = result("ParameterMap").to_pandas()
    assert cells.index.names == ["A0", "f"] and set(cells["regime"]) == {"periodic"}
    strobes = result("BifurcationDiagram").to_pandas()
    assert len(strobes) == 8 and set(strobes["regime"]) == {"periodic"}
    assert list(result("Run").to_pandas(rows="jump").columns) == ["jump_time", "jump_contact", "jump_force"]


def test_errors_and_regimes_stand_beside_the_numbers() -> None:
    curve = result("Curve").to_xarray()
    assert 0.0 < float(curve.error_estimate.max()) < 1e-2 and set(curve.regime.values) == {"periodic"}
    assert curve.attrs["scene_name"] == "sec2" and curve.attrs["knob_A0_unit"] == "m"
    assert result("Curve driven").to_xarray().drive_amplitude.attrs["units"] == "m"
    parameters = result("Fit").to_pandas()
    assert parameters.loc["D", "low"] < parameters.loc["D", "best"] < parameters.loc["D", "high"]
    run = result("Run").to_xarray()
    assert float(run.max_output_force) == result("Run").max_output_force  # type: ignore[attr-defined]
    assert run.max_output_force.attrs["units"] == "N"
    assert run.regime.item() == result("Run").regime.name and float(run.error_estimate_displacement) > 0.0  # type: ignore[attr-defined]
    runs = result("Runs").to_pandas()
    assert list(runs["wall"]) == ["bead", "rigid", "bead"] and list(runs["N"]) == [2, 2, 3] and runs["max_output_force"].is_unique


ALONE = "rk4-split or dop853"
BATCH = "rk4 corrected at contact events, in batches"
FLOW = "tangent flow (DOP853, time substitution at events)"


@pytest.mark.parametrize(("kind", "method"), [
    ("Run", "rk4-split"), ("Orbit", FLOW), ("Branch", FLOW), ("LyapunovSpectrum", FLOW), ("BifurcationDiagram", f"{ALONE} value by value"),
    ("Curve", f"{BATCH}, {ALONE} point by point"), ("ParameterMap", f"{BATCH}, {ALONE} cell by cell"),
    ("Basins", f"{BATCH}, {ALONE} start by start; orbits by {FLOW}"),
    ("Attractors", f"{BATCH}, {ALONE} start by start; orbits by {FLOW}"),
])
def test_a_result_names_the_method_that_computed_it(kind: str, method: str) -> None:
    assert result(kind).attributes()["method"] == method


def test_chains_that_share_no_batch_and_have_no_orbit_do_not_name_them() -> None:
    found = granchain_core.attractors(CHAIN.evolve(tension="cut"), random_states=0)
    assert found.attributes()["method"] == "dop853 start by start"


def test_error_estimate_is_the_error_that_the_command_line_calls_so() -> None:
    """For a motion it is the error of the displacements, for a curve point or an attractor that of the output force."""
    for kind in ("Run", "Driven", "Observation"):
        motion: Any = result(kind)
        assert motion.error_estimate == motion.displacement_error > 0.0, kind
    curve, found = (cast("Any", result(kind)) for kind in ("Curve", "Attractors"))
    for one in (curve.points[0], found[0]):
        assert one.error_estimate == one.force_errors.output > 0.0


@pytest.mark.parametrize("kind", RESULTS)
def test_a_cell_shows_a_few_lines_and_no_numbers_by_the_thousand(kind: str) -> None:
    shown = result(kind)._repr_mimebundle_()
    assert 2 <= len(shown["text/plain"].splitlines()) < 30 and "sec2" in shown["text/plain"]
    assert len(shown["text/html"]) < 20_000 and "<details>" in shown["text/html"]


def test_an_unknown_table_or_axis_is_named_with_the_known_ones() -> None:
    with pytest.raises(BadInput, match="Unknown table 'specials'; the nearest is 'special'"):
        result("Branch").to_xarray("specials")
    with pytest.raises(BadInput, match="Unknown axis 'beads'; the nearest is 'bead'"):
        result("Run").to_pandas(rows="beads")


@pytest.mark.parametrize(("call", "library"), [("to_xarray", "xarray"), ("to_pandas", "pandas")])
def test_a_missing_library_is_one_sentence(call: str, library: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(BadInput, match=rf"^{call} needs the package {library}; install it with `pip install {library}`, "):
        getattr(result("Run"), call)()


def test_nothing_imports_the_libraries_before_they_are_asked_for() -> None:
    program = ("import sys; from granchain_core import run, scene, resonance_curve, orbit, parameter_map, fit, basins, save; "
               "run(scene('sec2').evolve(N=2, f=2000.0), periods=0, record=1, samples=8)._repr_html_(); "
               "print([m for m in ('xarray', 'pandas', 'bokeh', 'panel') if m in sys.modules])")
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout == "[]\n"


# --- many scenes ------------------------------------------------------------------------------------------


def test_many_scenes_are_returned_in_order_with_progress_and_failures() -> None:
    told: list[float] = []
    slow = CHAIN.evolve(f=0.5, accuracy=1e-9)
    found = run_many([CHAIN, slow, CHAIN.evolve(D=50.0)], progress=told.append, periods=40, record=1, samples=8, budget=2.0)
    assert told == pytest.approx([1 / 3, 2 / 3, 1.0])
    assert found[1] is None and "budget" in found.failures[1]
    alone = granchain_core.run(CHAIN.evolve(D=50.0), periods=40, record=1, samples=8)
    assert found[2] is not None and found[2].max_output_force == alone.max_output_force  # type: ignore[union-attr]
    assert np.isnan(found.to_xarray().max_output_force[1])


def test_many_scenes_can_be_stopped_and_refused() -> None:
    stop = Stop()
    with pytest.raises(granchain_core.Cancelled):
        run_many([CHAIN] * 8, stop=stop, progress=lambda _: stop.set(), periods=40, record=1, samples=8)
    with pytest.raises(BadInput, match="1 to 100000 scenes, not 0"):
        run_many([])
