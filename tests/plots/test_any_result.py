"""`granchain.figure` draws every result in a suitable size, and refuses everything else with one sentence."""

from __future__ import annotations

import numpy as np
import pytest
from bokeh.models import ColumnDataSource, LayoutDOM
from bokeh.plotting import figure

import granchain
from app.plots.any_result import HEIGHT, WIDTH
from app.plots.probe import FIGURES, probe_state
from granchain import BadInput, scene
from granchain_core.accuracy import Row
from granchain_core.experiment import read_data
from granchain_core.fitting import CurveTarget, Free
from granchain_core.paper import compute

CHAIN = scene("sec2").evolve(N=2, f=2000.0)
TIME = np.linspace(0.0, 1e-3, 65)
DATA = b"f [Hz],F [N],error [N]\n1800,3.3,0.1\n2000,2.3,0.1\n2200,1.9,0.1\n"
#: A result of each kind, and words in the label of one of its axes.
RESULTS = {
    "run": (lambda: granchain.run(CHAIN, periods=10, record=2, samples=16), "output force (N)"),
    "settled": (lambda: granchain.settle(CHAIN), "drive u₀ (nm)"),
    "driven": (lambda: granchain.drive(CHAIN, granchain.Signal.burst(CHAIN.A0, 2000.0, 4, 0.004)), "drive u₀ (nm)"),
    "pulse": (lambda: granchain.pulse(granchain.run(scene("impact").evolve(N=4), periods=0, record=1, samples=400)), "output force (N)"),
    "curve": (lambda: granchain.resonance_curve(CHAIN, [1800.0, 2000.0]), "largest output force (N)"),
    "orbit": (lambda: granchain.orbit(CHAIN), "real part of μ"),
    "branch": (lambda: granchain.branch(CHAIN, "f", 2000.0, 2020.0), "largest elastic output force (N)"),
    "parameter map": (lambda: granchain.parameter_map(CHAIN, ("f", [1900.0, 2000.0]), ("A0", [4e-7, 5e-7])), "drive amplitude A₀ (nm)"),
    "observation": (lambda: granchain.observe(CHAIN, TIME, np.sin(np.pi * TIME / 1e-3) ** 2), "time (ms)"),
    "accuracy": (lambda: granchain.WorkPrecision(CHAIN, "dop853", "SciPy's DOP853", 1e-12, [
        Row("rk4", "2 × the default steps", 1e-5, 0.001, 7, 2.0)]), "processor time"),
    "fit": (lambda: granchain.fit(CHAIN, CurveTarget(read_data(DATA)), [Free("D", 50.0, 200.0)], initial_points=2, intervals=False), "D"),
    "spectrum": (lambda: granchain.spectrum(granchain.settle(CHAIN).run), "amplitude of the output force (N)"),
    "transfer": (lambda: granchain.transfer(granchain.settle(CHAIN).run), "gain |H|"),
    "lyapunov": (lambda: granchain.lyapunov_spectrum(CHAIN, periods=20), "Lyapunov exponent per drive period"),
    "rotation": (lambda: granchain.rotation_number(scene("sec2").evolve(f=1700.0), 2000), "difference of halves of the record"),
    "strobes": (lambda: granchain.bifurcation_diagram(CHAIN, "f", [1900.0, 2000.0], keep=4),
                "displacement of bead 2 at drive phase 0 (nm)"),
    "basins": (lambda: granchain.basins(CHAIN, ("u1", [0.0, 1e-7]), ("v1", [0.0, 1e-3])), "displacement of bead 1 at the start (nm)"),
    "attractors": (lambda: granchain.attractors(CHAIN, random_states=2), "random states that lead there (%)"),
    "paper": (lambda: compute("5"), "velocity amplitude V0 (mm/s)"),
}


def labels(drawn: LayoutDOM) -> list[str]:
    """Return the labels of all axes."""
    plots = [drawn] if isinstance(drawn, figure) else list(drawn.select({"type": figure}))
    return [axis.axis_label or "" for plot in plots for axis in (*plot.xaxis, *plot.yaxis)]


@pytest.mark.parametrize("kind", RESULTS)
def test_every_result_has_a_figure_of_a_size_of_its_own(kind: str) -> None:
    make, words = RESULTS[kind]
    drawn = granchain.figure(make(), "dark", height=333)
    assert any(words in label for label in labels(drawn)), labels(drawn)
    assert drawn.sizing_mode == "fixed" and drawn.height == 333 and (drawn.width == WIDTH or kind == "paper")
    assert drawn.document is None


def test_a_motions_forces_have_their_jumps_and_its_map_its_energies() -> None:
    run = granchain.run(CHAIN, periods=40, record=2, samples=32)
    drawn = granchain.figure(run)
    sources = {one.name: one.data for one in drawn.select({"type": ColumnDataSource}) if one.name}
    jumps = run.jumps.of(0)[1]
    # In newtons, because the forces are a few newtons; in single precision, as on the page.
    assert len(jumps) and set(jumps.astype(np.float32)) <= set(sources["input force"]["force"])
    assert len(sources["input force"]["force"]) == len(run.time) + 2 * len(jumps)
    image = next(one.data["image"][0] for one in drawn.select({"type": ColumnDataSource}) if "image" in one.data)
    assert image == pytest.approx(run.kinetic_energy / 1e-9, rel=1e-6)


def test_a_long_motion_is_thinned_out() -> None:
    long = granchain.run(CHAIN, periods=0, record=300, samples=32)
    drawn = granchain.figure(long)
    image = next(one.data["image"][0] for one in drawn.select({"type": ColumnDataSource}) if "image" in one.data)
    assert 1000 < image.shape[0] <= 2000 < len(long.time)


def test_lists_are_drawn_together_and_options_reach_the_picture() -> None:
    up, down = (granchain.resonance_curve(CHAIN, [1800.0, 2000.0], start=start) for start in ("up", "down"))
    both = granchain.figure([up, down], elastic=True)
    assert {one.name for one in both.select({"type": ColumnDataSource})} == {"up", "down"}
    assert "elastic" in labels(both)[1] and both.height == HEIGHT
    found = granchain.parameter_map(CHAIN, ("f", [1900.0, 2000.0]), ("A0", [4e-7, 5e-7]))
    assert isinstance(granchain.figure(found, shown="regime"), figure)


def test_a_measured_curve_is_drawn_over_a_computed_one_and_within_its_scale() -> None:
    found = granchain.resonance_curve(CHAIN, [1800.0, 2000.0])
    measured = read_data(b"f [Hz],F [N],error [N]\n1900,5000,0.5\n")
    drawn = granchain.figure(found, measured=measured)
    source = drawn.select_one({"name": "measured", "type": ColumnDataSource})
    assert source.data["frequency"] == [1900.0] and source.data["force"] == [5.0]  # kN, by the larger of the two forces
    assert labels(drawn)[1] == "largest output force (kN)"


@pytest.mark.parametrize(("options", "bead"), [({}, 2), ({"bead": 1}, 1)], ids=["last", "chosen"])
@pytest.mark.parametrize("kind", FIGURES)
def test_a_motion_has_the_figures_of_the_page_probe(kind: str, options: dict[str, int], bead: int) -> None:
    found = granchain.settle(CHAIN)
    for result in (found, found.run):
        drawn = granchain.figure(result, kind=kind, **options)
        sources = {one.name: one.data for one in drawn.select({"type": ColumnDataSource})}
        expected = {name: state["data"] for name, state in probe_state(found.run, bead)[kind].items() if "data" in state}
        assert expected and {name: sources[name] for name in expected} == expected


@pytest.mark.parametrize(("make", "words"), [
    (lambda: granchain.figure(granchain.settle(CHAIN), kind="phaze"), "Unknown kind of figure 'phaze'; the nearest is 'phase'"),
    (lambda: granchain.figure(granchain.settle(CHAIN), kind="phase", bead=3), "bead = 3 is outside 1 to 2"),
    (lambda: granchain.figure(granchain.orbit(CHAIN), kind="phase"), "type Orbit has no figure of the kind 'phase'"),
    (lambda: granchain.figure(3.0), "type float has no figure; there are figures of Run, Settled, Driven, Pulse, Curve"),
    (lambda: granchain.figure([]), "type list has no figure"),
    (lambda: granchain.figure(granchain.orbit(CHAIN), "drak"), "Unknown theme 'drak'; the nearest is 'dark'"),
    (lambda: granchain.figure(granchain.resonance_curve(CHAIN, [2000.0]), measured="mine.csv"), "not a value of type str"),
    (lambda: granchain.figure(granchain.orbit(CHAIN), bead=1), "The figure of a Orbit has no option 'bead'"),
])
def test_results_that_cannot_be_drawn_are_refused_with_a_sentence(make, words: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(BadInput, match=words):
        make()
