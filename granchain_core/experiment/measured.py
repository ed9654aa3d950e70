"""A measured resonance curve, and the mark that distinguishes data of a virtual experiment from measured data."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

#: Largest file with a measurement [bytes].
MOST_BYTES = 50_000_000
#: Largest number of rows in a measured table.
MOST_ROWS = 1_000_000
#: First words of the note of computed data (granchain_core/virtual_experiment).
VIRTUAL = "virtual experiment"


class Noted:
    """Data with a note, which says whether they come from a virtual experiment."""

    note: str

    @property
    def virtual(self) -> bool:
        """Whether the data come from a virtual experiment, in which nothing was measured."""
        return self.note.startswith(VIRTUAL)

    @property
    def word(self) -> str:
        """Name of the data in the legends of pictures: "measured" or "virtual experiment"."""
        return VIRTUAL if self.virtual else "measured"


def note_of(own: str, given: str) -> str:
    """Return the note of data: the reader's if `given`, otherwise the file's `own`; both if the latter says virtual."""
    return f"{own}; {given}" if given and own.startswith(VIRTUAL) else given or own


@dataclass(frozen=True, eq=False)
class Measured(Noted):
    """Measured points in ascending frequency [Hz]: force [N], error [N] or None; `understood` describes the file.

    If a frequency was measured several times, `force` is the mean, `low` and `high` are the extremes [N], `repeats` is
    the number of measurements and `scatter` their standard deviation [N]; all None if the reader does not look for
    repeats. `units` are those of the file by quantity. `source` and `note` are the reader's and the file's own
    comments.
    """

    frequency: np.ndarray
    force: np.ndarray
    error: np.ndarray | None
    understood: str
    low: np.ndarray | None = None
    high: np.ndarray | None = None
    repeats: np.ndarray | None = None
    scatter: np.ndarray | None = None
    source: str = ""
    note: str = ""
    units: dict[str, str] = field(default_factory=dict)

    @property
    def bars(self) -> tuple[np.ndarray, np.ndarray]:
        """Return both ends of the error bars [N], from the error or, without one, from the extremes of the repeats."""
        if self.error is None and self.low is not None and self.high is not None:
            return self.low, self.high
        error = np.zeros(len(self.force)) if self.error is None else self.error
        return self.force - error, self.force + error
