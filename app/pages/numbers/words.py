"""A settled motion in words, and in the rows of two tables."""

from __future__ import annotations

import numpy as np

from granchain_core import Run
from granchain_core.scene.effects import effects_of

from ...format import in_words

#: Most instants in a table over time; the file has all.
_MOST_INSTANTS = 25
#: A value below this fraction of its series' largest is a rounded zero, for example the sine of a full turn.
_LARGEST_ROUNDED_ZERO = 1e-12
#: Most beads in a table; the file has all.
_MOST_BEADS = 200


def summary(run: Run) -> str:
    """Summarise the pictures in a few sentences."""
    energy = run.kinetic_energy
    row, bead = map(int, np.unravel_index(int(energy.argmax()), energy.shape))
    far = int(energy[:, -1].argmax())
    most = f"Bead {bead + 1} has the most kinetic energy, {_energy(energy, row, bead)} at {_time(run, row)}"
    last = f"; bead {run.scene.N}, at the wall, has at most {_energy(energy, far, run.scene.N - 1)}"
    return f"{_forces(run)} {most}{last if bead + 1 != run.scene.N else ''}. {_travel(run)}{_where_energy_goes(run)}"


def _forces(run: Run) -> str:
    """Describe the motion, and the largest forces at both ends with their ratio, which is not a ratio of energies."""
    pushed, arrived = (in_words(force, "N", 3) for force in (run.max_input_force, run.max_output_force))
    if not run.scene.is_driven:
        return (f"Nothing drives the chain; {_time(run, -1)} from its start are shown. The force on bead 1 from the "
                f"left is at most {pushed}, that on the wall at most {arrived}.")
    ratio = run.max_output_force / run.max_input_force if run.max_input_force > 0.0 else 0.0
    return (f"At {run.scene.f:g} Hz: {run.regime.sentence}. The driver pushes with at most {pushed}, and at most "
            f"{arrived} arrive at the wall, {ratio:.3g} times as much.")


def _travel(run: Run) -> str:
    """Describe the largest displacement of a bead from rest."""
    far = np.abs(run.displacement).max(axis=0)
    most = int(far.argmax())
    return f"Bead {most + 1} moves farthest, {in_words(float(far[most]), 'm', 3)} from its rest position."


def _where_energy_goes(run: Run) -> str:
    """Say where the driver's work goes in a steady motion, if only the contact damping dissipates energy.

    The wall takes none, because it does not move.
    """
    dissipating = [effect.name for effect in effects_of(run.scene) if effect.dissipates]
    if not run.scene.is_driven or dissipating != ["dashpot"]:
        return ""
    return " On average, the damping of the contacts takes all the energy from the driver; the wall takes none."


def forces_over_time(run: Run) -> list[list[str]]:
    """Return time, drive, input and output force at evenly spaced instants."""
    rows = np.unique(np.linspace(0, len(run.time) - 1, _MOST_INSTANTS).round().astype(int))
    series = ((run.drive_displacement, "m"), (run.input_force, "N"), (run.output_force, "N"))
    return [[_time(run, int(row)), *(_value(values, int(row), unit) for values, unit in series)] for row in rows]


def _value(values: np.ndarray, row: int, unit: str) -> str:
    """Return a value of a series in words; a rounded zero is shown as zero."""
    value = float(values[row])
    is_zero = abs(value) <= _LARGEST_ROUNDED_ZERO * float(np.abs(values).max())
    return f"0 {unit}" if is_zero else in_words(value, unit, 3)


def beads(run: Run) -> list[list[str]]:
    """Return each bead's largest sampled displacement, speed and kinetic energy, and the time of that energy."""
    energy = run.kinetic_energy
    return [[str(bead + 1), in_words(float(np.abs(run.displacement[:, bead]).max()), "m", 3),
             in_words(float(np.abs(run.velocity[:, bead]).max()), "m/s", 3),
             in_words(float(energy[:, bead].max()), "J", 3), _time(run, int(energy[:, bead].argmax()))]
            for bead in range(min(run.scene.N, _MOST_BEADS))]


def _energy(energy: np.ndarray, row: int, bead: int) -> str:
    return in_words(float(energy[row, bead]), "J", 3)


def _time(run: Run, row: int) -> str:
    return in_words(float(run.time[row] - run.time[0]), "s", 3)
