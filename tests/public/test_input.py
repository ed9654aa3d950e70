"""Public functions convert NumPy values to plain Python numbers and refuse unusable values with one sentence."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from granchain_core import (
    BadInput,
    Bead,
    LiveChain,
    Scene,
    State,
    attractors,
    basins,
    bifurcation_diagram,
    drive,
    load,
    lyapunov_spectrum,
    orbit,
    parameter_map,
    pulse,
    resonance_curve,
    rotation_number,
    run,
    run_many,
    save,
    scene,
    settle,
    spectrum,
    transfer,
)
from granchain_core.observers.twin import twin
from granchain_core.store import save_curve

CHAIN = scene("sec2").evolve(N=2, f=2000.0)
BEAD = CHAIN.pattern[0]


def test_counts_of_numpy_become_plain_ones_and_the_run_can_be_saved(tmp_path: Path) -> None:
    found = run(CHAIN, periods=np.int64(5), record=np.int32(1), samples=np.uint8(4))  # type: ignore[arg-type]
    assert type(found.regime.periods_run) is int and type(found.samples) is int
    json.dumps(dataclasses.asdict(found.regime))
    again = load(save(found, tmp_path / "counts.h5"))
    assert again.regime == found.regime and (again.displacement == found.displacement).all()


@pytest.mark.parametrize("call", [
    lambda wrong: run(CHAIN, periods=wrong), lambda wrong: run(CHAIN, record=wrong),
    lambda wrong: run(CHAIN, samples=wrong), lambda wrong: settle(CHAIN, samples=wrong),
    lambda wrong: orbit(CHAIN, period=wrong), lambda wrong: attractors(CHAIN, random_states=wrong),
    lambda wrong: attractors(CHAIN, random_states=1, seed=wrong), lambda wrong: lyapunov_spectrum(CHAIN, periods=wrong),
    lambda wrong: rotation_number(CHAIN, periods=wrong),
    lambda wrong: bifurcation_diagram(CHAIN, "A0", [5e-7], keep=wrong), lambda wrong: twin(CHAIN, periods=wrong),
    lambda wrong: twin(CHAIN, samples=wrong), lambda wrong: LiveChain(CHAIN, samples=wrong),
    lambda wrong: LiveChain(CHAIN).advance(wrong)])
@pytest.mark.parametrize("wrong", [2.5, "4", [1], True, math.nan])
def test_a_count_that_is_no_whole_number_is_refused(call: Callable[[Any], Any], wrong: object) -> None:
    with pytest.raises(BadInput, match=r"must be a whole number from \d+ to .*; the nearest valid value is \d"):
        call(wrong)


def test_the_nearest_whole_number_is_named() -> None:
    with pytest.raises(BadInput, match=r"periods = '3\.7' must be .* the nearest valid value is 4\."):
        run(CHAIN, periods=3.7)  # type: ignore[arg-type]
    with pytest.raises(BadInput, match=r"count = -1 is outside 1 to .* the nearest valid value is 1"):
        LiveChain(CHAIN).advance(-1)
    with pytest.raises(BadInput, match=r"samples = 5 must be even"):
        LiveChain(CHAIN, samples=5)


@pytest.mark.parametrize(("call", "sentence"), [
    (lambda: run("sec2"), r"A chain is given as a Scene, not as 'sec2'; scene\('sec2'\) is one"),
    (lambda: settle(None), "not as a value of type NoneType"), (lambda: orbit("rig"), r"scene\('rig'\)"),
    (lambda: resonance_curve("sec2", [300.0]), "given as a Scene"), (lambda: attractors(3), "given as a Scene"),
    (lambda: LiveChain("sec2"), "given as a Scene"), (lambda: LiveChain(CHAIN).change("a"), "given as a Scene"),
    (lambda: run_many(CHAIN, settle), r"\[scene\] is a list of one"), (lambda: run_many(["sec2"]), "given as a Scene"),
    (lambda: run_many(5), "must be a list"), (lambda: drive(CHAIN, None), "A drive is a Signal"),
    (lambda: spectrum(CHAIN), r"given as a Run, not as a value of type Scene; run\(scene\)"),
    (lambda: transfer(None), "given as a Run"), (lambda: pulse(CHAIN), "given as a Run"),
    (lambda: spectrum(settle(CHAIN)), "of type Settled; its attribute `run` is one"),
    (lambda: save(None, "nothing.h5"), "a result of granchain"),
    (lambda: run(CHAIN, budget=math.nan), "budget = nan must be a number of seconds"),
    (lambda: run(CHAIN, budget=-1.0), "budget = -1.0 must be a number of seconds"),
    (lambda: run(CHAIN, budget="1"), "budget = 1 must be a number of seconds"),
    (lambda: resonance_curve(CHAIN, 300.0), r"Frequencies must be a list or an array.*\[300\.0\] is a list of one"),
    (lambda: resonance_curve(CHAIN, "300"), "Frequencies must be a list or an array"),
    (lambda: resonance_curve(CHAIN, ["low"]), "Frequencies must be numbers"),
    (lambda: bifurcation_diagram(CHAIN, "A0", 5e-7), "The values of A0 must be a list"),
    (lambda: parameter_map(CHAIN, "f", ("A0", [5e-7])), r"x must be a name and its values, as in \(\"f\""),
    (lambda: parameter_map(CHAIN, ("f", 300.0), ("A0", [5e-7])), "The values of the axis f must be a list"),
    (lambda: basins(CHAIN, ("u1", 0.0), ("u2", [0.0])), "The values of u1 must be a list"),
    (lambda: CHAIN.evolve(f=True), "drive frequency f must be a number"),
    (lambda: CHAIN.evolve(accuracy=0), "^accuracy = 0 is outside")])
def test_arguments_of_a_wrong_type_are_refused_with_a_sentence(call: Callable[[], Any], sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        call()


def test_frequencies_may_come_from_a_generator() -> None:
    curve = resonance_curve(CHAIN, (f for f in (1900.0, 2000.0)))  # type: ignore[arg-type]
    assert [point.frequency for point in curve.points] == [1900.0, 2000.0]


def test_the_file_of_another_result_is_named_as_such(tmp_path: Path) -> None:
    path = save_curve(resonance_curve(CHAIN, [2000.0]), tmp_path / "curve.h5")
    with pytest.raises(BadInput, match=r"reads runs, and .* holds another result: its tables are curve; "
                                       r"granchain_core\.store\.load_curve reads"):
        load(path)
    with pytest.raises(BadInput, match=r"are multipliers, newton, state; xarray\.open_dataset\(path, group=.multipliers.\) reads one"):
        load(save(orbit(CHAIN), tmp_path / "orbit.h5"))


# --- scenes and beads, however they are created ---------------------------------------------------------------


@pytest.mark.parametrize("changes", [
    {"D": -5.0}, {"k": -1e5}, {"F0": -1.0}, {"f": 0.0}, {"f": -2000.0}, {"f": math.nan}, {"f": math.inf}, {"f": True},
    {"f": "2000"}, {"A0": 0.0}, {"A0": None}, {"accuracy": 0.0}, {"reference_overlap": 0.0}, {"N": 0}, {"N": "3"},
    {"N": 2.5}, {"site": 0}, {"tension": "no"}, {"end": "xx"}, {"drive": "xx"}, {"dissipation": "foo"},
    {"wall": "foo"}, {"wall": 0.0}, {"wall": None}, {"dimer": 0.0}, {"taper": -1.0}, {"strike": -1.0},
    {"pattern": ()}, {"pattern": (1.0,)}, {"impurities": ((3, BEAD),)}, {"impurities": ((1, BEAD), (1, BEAD))},
    {"start_velocity": ((0, 0.1),)}])
def test_a_replaced_value_that_no_chain_has_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(BadInput, match=next(iter(changes))):
        dataclasses.replace(CHAIN, **changes)


@pytest.mark.parametrize("changes", [{"mass": 0.0}, {"mass": -0.02}, {"radius": math.inf}, {"young": 0.0},
                                     {"young": "193e9"}, {"poisson": 1.0}, {"poisson": math.nan}])
def test_a_bead_that_no_sphere_is_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(BadInput, match=f"A bead's {next(iter(changes))} must be a finite number above"):
        dataclasses.replace(BEAD, **changes)


def test_numbers_of_numpy_and_lists_make_the_same_scene() -> None:
    bead = Bead(np.float32(0.5), np.int64(1), 193e9, 0.3)  # type: ignore[arg-type]
    assert [type(value) for value in dataclasses.astuple(bead)] == [float] * 4
    made = dataclasses.replace(CHAIN, f=np.float64(2000.0), N=np.int64(2), D=100, pattern=[BEAD])  # type: ignore[arg-type]
    assert made == CHAIN and made.digest == CHAIN.digest and hash(made) == hash(CHAIN)
    assert type(made.N) is int and type(made.D) is float


def test_a_scene_file_with_two_impurities_at_one_place_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "twice.toml"
    path.write_text('parent = "sec2"\n[chain]\nimpurities = [{place = 3, mass = 1e-3}, {place = 3, mass = 2e-3}]\n', "utf-8")
    with pytest.raises(BadInput, match=r"twice\.toml: The scene's impurities name bead 3 more than once"):
        scene(path)


def test_a_chain_shorter_than_its_special_beads_is_refused_by_its_number_of_beads() -> None:
    special = dataclasses.replace(CHAIN, impurities=((2, BEAD),))
    with pytest.raises(BadInput, match="N = 1 leaves no bead 2"):
        special.evolve(N=1)
    assert isinstance(special, Scene) and run(special, periods=0, record=1, samples=4, start=State(np.zeros(2), np.zeros(2)))
