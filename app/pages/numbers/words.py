"""A settled motion in words, and in the rows of two tables."""

from __future__ import annotations

import numpy as np

from granchain_core import Run

from ...format import in_words

#: Instants of a table over time; the file has all.
_INSTANTS = 25
#: Most beads of a table; the file has all.
_BEADS = 200


def summary(run: Run) -> str:
    """What the pictures show, in a few sentences."""
    energy = run.kinetic_energy
    row, bead = map(int, np.unravel_index(int(energy.argmax()), energy.shape))
    far = int(energy[:, -1].argmax())
    share = run.max_output_force / run.max_input_force if run.max_input_force > 0.0 else 0.0
    most = f"Bead {bead + 1} has the most kinetic energy, {_energy(energy, row, bead)} at {_time(run, row)}"
    last = f"; bead {run.scene.N}, at the wall, has at most {_energy(energy, far, run.scene.N - 1)}"
    return (f"At {run.scene.f:g} Hz: {run.regime.sentence}. The driver pushes with at most "
            f"{in_words(run.max_input_force, 'N', 3)}, and at most {in_words(run.max_output_force, 'N', 3)} arrive at "
            f"the wall, {100 * share:.3g} % of it. {most}{last if bead + 1 != run.scene.N else ''}."
            f"{_where_energy_goes(run)}")


def _where_energy_goes(run: Run) -> str:
    """What becomes of the driver's work in a steady motion: contacts alone lose energy, and the wall does not move."""
    if not (run.scene.is_driven and run.scene.has_dissipation):
        return ""
    return " On average, the damping of the contacts takes all the energy from the driver; the wall takes none."


def forces_over_time(run: Run) -> list[list[str]]:
    """Time, drive, input and output force at equal distances."""
    rows = np.unique(np.linspace(0, len(run.time) - 1, _INSTANTS).round().astype(int))
    return [[_time(run, int(row)), in_words(float(run.drive_displacement[row]), "m", 3),
             in_words(float(run.input_force[row]), "N", 3), in_words(float(run.output_force[row]), "N", 3)]
            for row in rows]


def beads(run: Run) -> list[list[str]]:
    """Of each bead the largest displacement, speed and kinetic energy, as sampled, and when it has that energy."""
    energy = run.kinetic_energy
    return [[str(bead + 1), in_words(float(np.abs(run.displacement[:, bead]).max()), "m", 3),
             in_words(float(np.abs(run.velocity[:, bead]).max()), "m/s", 3),
             in_words(float(energy[:, bead].max()), "J", 3), _time(run, int(energy[:, bead].argmax()))]
            for bead in range(min(run.scene.N, _BEADS))]


def _energy(energy: np.ndarray, row: int, bead: int) -> str:
    return in_words(float(energy[row, bead]), "J", 3)


def _time(run: Run, row: int) -> str:
    return in_words(float(run.time[row] - run.time[0]), "s", 3)
