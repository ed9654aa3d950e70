"""Results of `work_precision`: a row for each method and setting, and the references with which they are compared."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..former_names import with_former_names
from ..scene import Scene
from ..tables import Column, Labelled, Table, axis, provenance
from ..tables.provenance import Attribute
from .naive import NaiveComparison


@dataclass(frozen=True)
class Row:
    """One method at one setting: largest displacement error over the largest displacement, seconds, evaluations.

    `value` is the setting as a number. A row with a `failure` has neither error nor time. `wall_s` is the processor
    time of the computing thread, on which other load hardly has an effect; in other results, a field of this name is
    wall-clock time. Files and the command line's JSON have the name too, so it does not change.
    """

    method: str
    setting: str
    error: float
    wall_s: float
    rhs: int
    value: float = 0.0
    failure: str = ""


@with_former_names
@dataclass(eq=False, repr=False)
class WorkPrecision(Labelled):
    """Error against time for every method on one scene.

    Attributes
    ----------
    scene : Scene
        The chain.
    reference, second : str
        The method whose motion counts as exact, and the independent method that checks it.
    agreement : float
        Largest difference between the two over the largest displacement; NaN while it is unknown.
    rows : list of Row
        One for each method and setting: `method`, `setting`, `error`, `wall_s` (processor time [s]), `rhs`, and
        `failure`, a sentence.
    naive : NaiveComparison or None
        The force as naive methods compute it.
    disagreement : str
        Why the second method failed; empty if it did not.

    Examples
    --------
    >>> from granchain_core import WorkPrecision, scene
    >>> WorkPrecision(scene("sec2"), "dop853", "SciPy's DOP853").cheapest(1e-6) is None
    True
    """

    scene: Scene
    reference: str
    second: str
    agreement: float = float("nan")
    rows: list[Row] = field(default_factory=list)
    naive: NaiveComparison | None = None
    disagreement: str = ""

    def cheapest(self, error: float) -> Row | None:
        """Return the fastest setting of granchain's and SciPy's methods that is at least this accurate."""
        return cheapest(self.rows, error)

    def tables(self) -> tuple[Table, ...]:
        """Return one table, `accuracy`: error and time of each method at each setting."""
        def column(name: str, unit: str, meaning: str, kind: type = float) -> dict[str, Column]:
            values: np.ndarray = np.array([getattr(row, name) for row in self.rows], dtype=kind)
            return {name: Column(values, ("row",), unit, meaning)}

        return (Table("accuracy", axis("row", np.arange(len(self.rows)), "1", "number of the measurement"), {
            **column("method", "", "name of the method", object), **column("setting", "", "its setting", object),
            **column("value", "1", "its setting as a number"),
            **column("error", "1", "largest error of a displacement over the largest displacement"),
            **column("wall_s", "s", "processor time of ten drive periods, on the computing thread"),
            **column("rhs", "1", "evaluations of the equations of motion", np.int64),
            **column("failure", "", "why there is neither error nor time; empty where there are", object)}),)

    def attributes(self) -> dict[str, Attribute]:
        """Return both references, their agreement, and the provenance."""
        return {**provenance(self.scene, self.reference, None), "reference": self.reference,
                "second": self.second, "agreement": self.agreement, "disagreement": self.disagreement}

    def summary(self) -> list[str]:
        """Return the agreement of the references, and the cheapest setting for each of three accuracies."""
        ways = [f"cheapest to {error:g}: {best.method}, {best.setting}, {1e3 * best.wall_s:.3g} ms"
                for error in (1e-3, 1e-6, 1e-9) if (best := self.cheapest(error)) is not None]
        return [f"{len(self.rows)} settings; {self.reference} and {self.second} agree to {self.agreement:.1e}", *ways]


def cheapest(rows: list[Row], error: float) -> Row | None:
    """Return the fastest row that is at least this accurate; failed rows never are."""
    good = [row for row in rows if not row.failure and row.error <= error]
    return min(good, key=lambda row: row.wall_s) if good else None
