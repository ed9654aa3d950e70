"""Force trains: a jump is drawn as a vertical rise to its top, in every copy of an orbit and in the moving live
picture.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bokeh.models import Range1d

from app.frames import LiveWindow, settled_frames, with_jumps
from app.parts.time_figures.pinned_trains import MOST_POINTS
from app.parts.time_figures.trains import ForceTrains
from granchain_core import LiveChain, scene, settle
from granchain_core.fitting.overlay import Overlay

CHAIN = scene("sec2").evolve(D=300.0, f=100.0, accuracy=1e-4)


def test_a_jump_is_two_points_at_one_time() -> None:
    time, force = with_jumps(np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.0, 3.0]), np.array([[1.4, 4.0]]))
    assert time.tolist() == [0.0, 1.0, 1.4, 1.4, 2.0]
    assert force.tolist() == [0.0, 0.0, 0.0, 4.0, 3.0]


def test_a_force_without_jumps_is_drawn_as_it_is() -> None:
    time, force = with_jumps(np.arange(3.0), np.arange(3.0), np.zeros((0, 2)))
    assert time.tolist() == force.tolist() == [0.0, 1.0, 2.0]


def test_the_largest_value_drawn_is_the_largest_force_stated() -> None:
    """In the settled picture, every copy of the orbit has its jumps at the same phase."""
    run = settle(CHAIN).run
    frames = settled_frames(run)
    for jumps, series, largest in ((frames.input_jumps, frames.input_force, run.max_input_force),
                                   (frames.output_jumps, frames.output_force, run.max_output_force)):
        time, force = with_jumps(frames.time, series, jumps)
        assert (np.diff(time) >= 0.0).all()
        # a smooth peak is drawn low by up to (spacing/2)²/2 of its curvature, being between rows; a jump's top is exact
        assert force.max() == pytest.approx(largest, rel=1e-12 if len(jumps) and jumps[:, 1].max() > 0.99 * largest else 1e-3)
    copies = round(frames.time[-1] * CHAIN.f)
    phases = np.sort((frames.output_jumps[:, 0] * CHAIN.f) % 1.0).reshape(-1, copies)
    assert np.ptp(phases, axis=1).max() < 1e-9


def test_a_pull_and_a_lasting_pressure_are_shown_beside_the_largest_force() -> None:
    """At 340 Hz, the driver's contact pulls when it opens; at 2500 Hz, the wall is always under pressure."""
    for f, told in ((340.0, (True, False)), (2500.0, (True, True))):
        run = settle(scene("sec2").evolve(f=f)).run
        frames, trains = settled_frames(run), ForceTrains(Range1d())
        trains.update(frames, frames.time, frames.extremes, True)
        words = trains.peak_words(frames, (run.max_input_force, run.max_output_force), (run.force_errors.input, run.force_errors.output))
        assert tuple(bool(least) for _, least in words) == told
        for (most, least), series in zip(words, (frames.input_force, frames.output_force), strict=True):
            number, unit = most.removeprefix("max ").split("\N{NO-BREAK SPACE}")
            assert float(number) * {"N": 1.0, "mN": 1e-3}[unit] == pytest.approx(series.max(), rel=1e-2)
            if least:
                assert float(least.removeprefix("min ≈ ").split("\N{NO-BREAK SPACE}")[0].replace("\N{MINUS SIGN}", "-")) <= float(number)
                number = least.removeprefix("min ≈ ").split("\N{NO-BREAK SPACE}")[0].replace("\N{MINUS SIGN}", "-")
                low = float(number) * {"N": 1.0, "mN": 1e-3}[unit]
                assert low == pytest.approx(series.min(), rel=0.5 if low < 0.0 else 0.05)  # one digit and two


@pytest.mark.parametrize(("least", "most", "axis", "error", "words"), [
    (-0.3271, 0.8014, "mN", None, ["max 800 mN", "min ≈ −300 mN"]),
    (8.1627, 8.1634, "N", 1e-5, ["max 8.16 N", "min ≈ 8.16 N"]),
    (-1.2e-6, 1.449e-6, "N", 1e-5, ["max 1.45 µN", "min ≈ −1 µN"]),
    (0.0, 8.0, "N", None, ["max 8.0 N", ""])])
def test_forces_under_the_axes_have_no_power_of_ten(least: float, most: float, axis: str, error: float | None,
                                                    words: list[str]) -> None:
    series, trains = np.array([least, most]), ForceTrains(Range1d())
    frames = replace(settled_frames(settle(CHAIN).run), input_force=series, output_force=series)
    trains._factors, trains._units = ({"N": 1.0, "mN": 1e-3}[axis],) * 2, ("m", axis, axis)
    for found in trains.peak_words(frames, (most, most), (error, error)):
        assert [one.replace("\N{NO-BREAK SPACE}", " ") for one in found] == words
    assert trains.output_words(8.0, None) == {"N": "about 8.0 N", "mN": "about 8000 mN"}[axis]
    assert trains.output_words(1.449e-6, 1e-5) == "1.449 µN"


def test_a_long_measured_series_is_drawn_to_the_end_of_the_picture_with_its_largest_force() -> None:
    time = np.linspace(0.0, 1.0, 100_001)
    force = np.where(np.arange(len(time)) == 77_777, 5.0, np.sin(300.0 * time))
    trains = ForceTrains(Range1d())
    trains._measured.load(Overlay(time, {"output_force": force}, None))
    trains._measured.update(1.0, 1.0, 1.0, 1.0, 1.0)
    drawn = next(one.data_source.data for one in trains._measured._lines.values())
    assert len(drawn["time"]) <= MOST_POINTS and drawn["time"][0] < 1e-3 and drawn["time"][-1] > 1.0 - 1e-3
    assert drawn["force"].max() == 5.0 and drawn["force"].min() == pytest.approx(-1.0) and (np.diff(drawn["time"]) >= 0.0).all()


def test_live_jumps_move_with_the_picture() -> None:
    """Times are drive periods before now: a jump seen in one part is older by the next part's length afterwards."""
    chain, samples = LiveChain(CHAIN), 96
    window = LiveWindow(samples)
    first = window.add(chain.advance(2 * samples))
    second = window.add(chain.advance(samples))
    assert len(first.input_jumps) > 0
    newest = first.input_jumps[-1]
    assert np.abs(second.input_jumps - (newest - [1.0, 0.0])).sum(axis=1).min() < 1e-12
    for _ in range(6):
        last = window.add(chain.advance(samples))
    assert last.input_jumps[:, 0].min() >= -4.0 and last.input_jumps[:, 0].max() <= 0.0
