"""Special points of a branch: their kinds, and for each point an interval of the knob and the two orbits around it.

`KINDS` lists all kinds, with their names in AUTO and MatCont. special_search.py finds the points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...former_names import with_former_names
from .normal_forms import NONDEGENERATE, NOT_DECIDED, NormalForm
from .point import BranchPoint

_BOTH_KNOBS = "the two orbits' knobs"


@dataclass(frozen=True)
class Kind:
    """A kind of special point: its name in results, files and JSON, its words, and its names in AUTO and MatCont.

    `passes` says what changes there, and `interval` defines the stated interval of the knob. `has_normal_form`: its
    criticality is decided by the coefficient of a normal form (normal_forms.py).
    """

    name: str
    words: str
    auto: str
    matcont: str
    passes: str
    interval: str = _BOTH_KNOBS
    has_normal_form: bool = False


#: All kinds of special points.
KINDS = (
    Kind("fold", "fold", "LP", "LPC", "a real multiplier passes +1 and the branch turns back in the knob",
         "from the nearer orbit to the farthest point where the tangents of both can meet", has_normal_form=True),
    Kind("period_doubling", "period doubling", "PD", "PD", "a real multiplier passes −1", has_normal_form=True),
    Kind("neimark_sacker", "Neimark–Sacker", "TR", "NS", "a complex pair passes the unit circle",
         has_normal_form=True),
    Kind("multiplier_one", "multiplier +1 without a fold", "BP", "BPC",
         "a real multiplier passes +1 and the knob does not turn: not classified; it may be a branch point"),
    Kind("grazing", "grazing", "", "",
         "a contact has one contact phase or one separation more, or less, per period of the orbit"),
)
#: The end `merged` of a doubled branch (ends.py), which AUTO and MatCont report as a branch point.
MERGED = Kind("period_doubling", "the end `merged` of a doubled branch", "BP", "BPC",
              "a doubled branch meets its parent: one of its own multipliers passes +1")
SPECIAL_KINDS = tuple(kind.name for kind in KINDS)
#: Kinds with a normal form. Stability may also change at `multiplier_one`, which has none here.
BIFURCATIONS = tuple(kind.name for kind in KINDS if kind.has_normal_form)
_WORDS = {kind.name: kind.words for kind in KINDS}


@with_former_names
@dataclass(frozen=True, eq=False)
class SpecialPoint:
    """A special point: its kind, the interval of the knob that contains it, and the two orbits around it.

    `kind` is one of `SPECIAL_KINDS`; `knob` is the middle of the interval. `contact` and `gained` describe a grazing:
    on its side `gained_side` the contact has one more contact phase ("closed interval" in `gained`) or separation
    ("open interval") per period of the orbit. `multiplier` passes the unit circle at the point. `normal_form` has the
    criticality and its coefficient; it is None for a grazing, for `multiplier_one`, at the end of a doubled branch,
    and in older files.
    """

    kind: str
    knob: float
    interval: tuple[float, float]
    before: BranchPoint
    after: BranchPoint
    multiplier: complex | None = None
    contact: int | None = None
    gained: str | None = None
    normal_form: NormalForm | None = None

    @property
    def gained_side(self) -> str | None:
        """Side of `knob` on which a contact has one `gained` more: "below" or "above"; None where the knob turns."""
        if self.contact is None or self.before.knob_direction != self.after.knob_direction:
            return None
        more, fewer = more_and_fewer(self.before, self.after, self.contact)
        return None if more.knob == fewer.knob else "below" if more.knob < fewer.knob else "above"

    @property
    def kind_words(self) -> str:
        """The kind in words."""
        return _WORDS[self.kind]

    @property
    def criticality(self) -> str | None:
        """One of `CRITICALITIES` (normal_forms.py); None where there is no normal form."""
        return None if self.normal_form is None else self.normal_form.criticality

    def criticality_words(self) -> str:
        """The criticality, with the reason where it is not decided; "" where there is no normal form."""
        form = self.normal_form
        if form is None:
            return ""
        if form.criticality == NOT_DECIDED:
            undecided = "not known to be nondegenerate" if self.kind == "fold" else "criticality not decided"
            return f"{undecided}: {form.reason}"
        return "nondegenerate" if form.criticality == NONDEGENERATE else form.criticality

    @property
    def angle(self) -> float | None:
        """Angle in radians by which the map rotates about the orbit: the argument of a Neimark–Sacker multiplier."""
        if self.kind != "neimark_sacker" or self.multiplier is None:
            return None
        return float(np.angle(self.multiplier))


def more_and_fewer(a: BranchPoint, b: BranchPoint, contact: int) -> tuple[BranchPoint, BranchPoint]:
    """The two orbits, first the one along which a contact closes more often."""
    return (a, b) if closings_of(a, contact) > closings_of(b, contact) else (b, a)


def closings_of(point: BranchPoint, contact: int) -> int:
    """Number of closings of a contact along the orbit."""
    return max(0, int(point.closings[contact]))
