"""Coexisting steady states as results, with the starts that lead to each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..orbits import Orbit
from ..orbits.stroboscopic_map import FLOW_METHOD
from ..results.forces import ForceErrors
from ..results.regime import Regime
from ..results.regime_columns import evidence_columns, regime_columns
from ..scene import Scene
from ..scene.state import State
from ..steady.batch.starts import settling_methods
from ..tables import MAXIMA, Column, Labelled, Table, axis, bead_axis, error_columns, force_columns, provenance
from ..tables.provenance import Attribute, or_nan
from ..tables.shown import as_text
from ..tables.words import state_columns

#: Number of failed starts that a sentence names.
_NAMED = 4


@dataclass(frozen=True, eq=False)
class Origin:
    """One start: its name, "rest", "up", "down" or "random 17", and its state at phase 0."""

    name: str
    state: State


@dataclass(eq=False)
class Attractor:
    """A steady state to which starts lead, or an unstable orbit that a start had not left after three rounds.

    Such an orbit is no attractor: `stable` is False, and its share is that of undecided starts.

    Attributes
    ----------
    scene : Scene
        The chain.
    regime : Regime
        What kind of motion it is.
    max_input_force, max_output_force, max_output_force_elastic : float
        Largest forces [N].
    force_errors : ForceErrors
        Their relative errors; each None if the motion is not periodic.
    state : State
        A state of it at drive phase 0.
    orbit : Orbit or None
        The converged orbit with its multipliers; None if the motion is not periodic or Newton's method did not reach
        it.
    origins : list of Origin
        The starts that end here: "rest", "up", "down", "random 17".
    share, share_error : float or None
        Fraction of the starts named in `share_of` that end here, and its standard error if these are random; otherwise
        None.
    share_interval : tuple of float or None
        The 95 % interval of the share if the starts are random; otherwise None.
    share_of : str
        The starts that the share refers to: "random states" for `attractors`, "starts of the plane" for `basins`.

    Examples
    --------
    >>> from granchain_core import attractors, scene
    >>> only, = attractors(scene("sec2").evolve(N=2, f=2000.0), random_states=2)
    >>> only.stable, [origin.name for origin in only.origins][:3]
    (True, ['rest', 'up', 'down'])
    """

    scene: Scene
    regime: Regime
    max_input_force: float
    max_output_force: float
    max_output_force_elastic: float
    force_errors: ForceErrors
    state: State
    orbit: Orbit | None = None
    origins: list[Origin] = field(default_factory=list)
    share: float | None = None
    share_error: float | None = None
    share_of: str = "random states"
    share_interval: tuple[float, float] | None = None

    @property
    def error_estimate(self) -> float | None:
        """`force_errors.output`, under its name in the command line's JSON.

        For a single motion, this name means the error of the displacements (docs/result-files.md, "Which name is which
        error").
        """
        return self.force_errors.output

    @property
    def share_words(self) -> str:
        """The share with its 95 % interval in per cent, or "–" if there is no share."""
        if self.share is None:
            return "–"
        if self.share_interval is None:
            return f"{100.0 * self.share:.0f} %"
        low, high = self.share_interval
        return f"{100.0 * self.share:.0f} % ({100.0 * low:.0f} to {100.0 * high:.0f} %)"

    @property
    def stable(self) -> bool | None:
        """Whether the multipliers of its orbit are all inside the unit circle; None where they are not known."""
        return None if self.orbit is None else self.orbit.stable


class Attractors(list[Attractor], Labelled):
    """The list of steady states that were found, the one to which most starts lead first.

    Attributes
    ----------
    scene : Scene
        The chain.
    failed : list of Origin
        The starts whose computation failed. For shares, they are counted among the random states.

    Examples
    --------
    >>> from granchain_core import attractors, scene
    >>> found = attractors(scene("sec2").evolve(N=2, f=2000.0), random_states=2)
    >>> len(found), found.summary()[1].split(",")[0]
    (1, '1: period 1')
    """

    scene: Scene
    failed: list[Origin]

    def __init__(self, chain: Scene, listed: Iterable[Attractor] = (), failed: Iterable[Origin] = ()) -> None:
        super().__init__(listed)
        self.scene = chain
        self.failed = list(failed)

    def tables(self) -> tuple[Table, ...]:
        """One table, `attractors`: regime, largest forces with errors, share, starts, and state of each."""
        return (attractors_table(self.scene, self),)

    def attributes(self) -> dict[str, Attribute]:
        """Provenance, and the largest error of a force."""
        errors = [attractor.force_errors.output for attractor in self if attractor.force_errors.output is not None]
        return dict(provenance(self.scene, attractor_methods(self.scene, self), max(errors) if errors else None))

    def summary(self) -> list[str]:
        """The number of steady states, one line for each, and the failed starts."""
        return [f"{len(self)} found", *(f"{i}: {line}" for i, line in enumerate(listing(self), 1)),
                *failed_sentence(self.failed)]

    def __repr__(self) -> str:
        return as_text(self.heading(), self.summary())


def attractor_methods(scene: Scene, listed: Iterable[Attractor]) -> str:
    """The methods behind the attractors of `scene`, in words for provenance."""
    has_orbits = any(attractor.orbit is not None for attractor in listed)
    return settling_methods(scene, "start") + (f"; orbits by {FLOW_METHOD}" if has_orbits else "")


def attractors_table(scene: Scene, listed: Sequence[Attractor]) -> Table:
    """Steady states as a table."""
    along = ("attractor",)
    forces = np.array([[getattr(attractor, name) for name in MAXIMA] for attractor in listed]).reshape(-1, 3)
    errors = np.array([attractor.force_errors.row for attractor in listed]).reshape(-1, 3)
    stable = np.array([-1 if attractor.stable is None else int(attractor.stable) for attractor in listed],
                      dtype=np.int8)
    intervals = np.array([attractor.share_interval or (np.nan, np.nan) for attractor in listed]).reshape(-1, 2)
    starts = np.array([", ".join(origin.name for origin in attractor.origins) for attractor in listed], dtype=object)
    states = np.array([[attractor.state.displacement, attractor.state.velocity]
                       for attractor in listed]).reshape(-1, 2, scene.N)
    return Table("attractors", {
        **axis("attractor", np.arange(1, len(listed) + 1), "1", "number of the steady state"), **bead_axis(scene.N)}, {
        **force_columns(forces, along), **error_columns(errors, along),
        **regime_columns([attractor.regime for attractor in listed], "attractor"),
        **evidence_columns([attractor.regime for attractor in listed], "attractor"),
        "stable": Column(stable, along, "1", "1 if no multiplier of its orbit is outside, 0 if one is, -1 unknown"),
        "share": Column(np.array([or_nan(attractor.share) for attractor in listed]), along, "1",
                        "fraction of the random states, or of a plane's starts, that end here"),
        "share_error": Column(np.array([or_nan(attractor.share_error) for attractor in listed]), along, "1",
                              "standard error of the share"),
        "share_low": Column(intervals[:, 0], along, "1", "lower end of the 95 % interval of the share"),
        "share_high": Column(intervals[:, 1], along, "1", "upper end of the 95 % interval of the share"),
        "share_of": Column(np.array([attractor.share_of for attractor in listed], dtype=object), along, "",
                           "the starts that the share refers to"),
        "starts": Column(starts, along, "", "starts that end here"),
        **state_columns(states[:, 0], states[:, 1], ("attractor", "bead"))})


def listing(attractors_found: Sequence[Attractor]) -> Iterator[str]:
    """Yield the attractors in words, one line each."""
    for attractor in attractors_found:
        share = "" if attractor.share is None else f"{attractor.share_words} of {attractor.share_of}; "
        yield f"{attractor.regime.sentence}; {attractor.max_output_force:.4g} N, {share}{len(attractor.origins)} starts"


def failed_sentence(failed: Sequence[Origin]) -> list[str]:
    """One sentence about the failed starts, with the names of the first; an empty list if none failed."""
    if not failed:
        return []
    names = ", ".join(origin.name for origin in failed[:_NAMED])
    others = f" and {len(failed) - _NAMED} more" if len(failed) > _NAMED else ""
    return [f"{len(failed)} start{'' if len(failed) == 1 else 's'} failed: {names}{others}"]
