"""Shows a picture with one batch of changes to data sources and one message to the chain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from granchain_core import Run, Scene, Settled

from ..format import prefixed
from ..frames import PERIODS, Frames, prepared_frames, round_up
from ..parts.chain.chain import frames_message
from ..parts.status.status_line import run_entries, settled_entries
from ..serve.document.changes import set_properties
from ..session.live import LiveStep
from .layout import Views


def show_settled(views: Views, number: int, settled: Settled) -> None:
    """Show a settled picture; the browser replays its whole periods."""
    frames = prepared_frames(settled.run)
    factor, letter = prefixed(float(frames.time[-1]))
    views.trains.name_time(f"time ({letter}s){_periods_shown(frames, settled.run.scene)}")
    _draw(views, number, frames, settled.run, frames.time / factor, f"{letter}s",
          (settled.run.max_input_force, settled.run.max_output_force), final=settled.final)
    views.curve.mark_motion(settled.run.scene.knobs["f"], settled.run.max_output_force)
    show_regime(views, settled)


def show_regime(views: Views, settled: Settled) -> None:
    """Update the status line; with a complete curve, it says on which peak or valley the motion lies."""
    run = settled.run
    force = views.trains.output_words(run.max_output_force, run.force_errors.output)
    views.status_line.update_state(**settled_entries(settled, views.curve.place(run), force))


def show_live(views: Views, number: int, step: LiveStep, running: bool) -> None:
    """Show the last periods of the live run, with the present at the bottom."""
    frames, run = step.frames, step.run
    time, unit, since = frames.time, "drive periods", f"drive period {step.periods:.0f}"
    if not run.scene.is_driven:
        factor, letter = prefixed(PERIODS / run.scene.f)
        time, unit = frames.time / (run.scene.f * factor), f"{letter}s"
        since = f"{1e3 * step.periods / run.scene.f:.0f} ms after the start"
    views.trains.name_time(f"time before now ({unit})")
    here = frames.extremes
    _draw(views, number, frames, run, time, unit, (here.input_force, here.output_force), live=True,
          running=running)
    views.curve.mark_motion(run.scene.knobs["f"], frames.largest_output)
    views.status_line.update_state(regime=f"live, {since}", regime_shorter=[], regime_hint="", start="",
                                   **run_entries(run, views.trains.output_words(frames.largest_output,
                                                                                run.force_errors.output)))


def _periods_shown(frames: Frames, scene: Scene) -> str:
    """Return the length of the time axis in drive periods, with an orbit's repetitions; empty without a drive."""
    count = round(float(frames.time[-1]) * scene.f)
    return f", {count} drive period{'s' * (count != 1)}" if scene.is_driven else ""


def _draw(views: Views, number: int, frames: Frames, run: Run, time: np.ndarray, unit: str,
          largest: tuple[float, float], live: bool = False, running: bool = False, final: bool = False) -> None:
    scene, errors = run.scene, (run.force_errors.input, run.force_errors.output)
    set_properties(views.time, start=float(time[-1]), end=float(time[0]))
    high = views.scales.of(frames, scene)
    high = replace(high, kinetic_energy=round_up(high.kinetic_energy))
    views.trains.update(frames, time, high, scene.is_driven)
    views.energy.update(frames, time, unit, high.kinetic_energy)
    peaks = views.trains.peak_words(frames, largest, errors)
    views.chain.send(**frames_message(number, frames, scene, high, views.scales.fit, peaks, live, running, final))
