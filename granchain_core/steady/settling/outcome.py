"""A settled chain: its steady state as a recorded motion, its regime, and the start of the motion."""

from __future__ import annotations

import json
from dataclasses import dataclass

from ...results.regime import Regime
from ...results.run import GIVEN_STATE, Run
from ...scene import Scene
from ...scene.state import State
from ...tables import Labelled, Table, bead_axis
from ...tables.provenance import Attribute
from ...tables.words import state_columns


@dataclass(frozen=True, eq=False, repr=False)
class Settled(Labelled):
    """A settled chain as a recorded motion, or its motion so far; `SteadyState` is the counterpart without a record.

    Attributes
    ----------
    run : Run
        The recorded orbit, or a few periods if the motion is not periodic.
    regime : Regime
        What kind of motion it is.
    state : State
        State of the chain at drive phase 0.
    start : str
        Where the motion started: "rest" or "previous state"; `run.start` has the words used for runs.
    preview : bool
        Whether this is a preview, before the regime is decided.
    final : bool
        Whether this is the last and best result.

    Examples
    --------
    >>> from granchain_core import scene, settle
    >>> found = settle(scene("sec2").evolve(N=2, f=2000.0), samples=16)
    >>> found.run.time.shape, found.state.displacement.shape
    ((17,), (2,))
    """

    run: Run
    regime: Regime
    state: State
    preview: bool
    final: bool

    @property
    def scene(self) -> Scene:
        """The chain."""
        return self.run.scene

    @property
    def start(self) -> str:
        """Where the motion started: "rest", also with the scene's initial velocities, or "previous state"."""
        return "previous state" if self.run.start == GIVEN_STATE else "rest"

    def tables(self) -> tuple[Table, ...]:
        """The tables of its run, and `state`, the state at drive phase 0."""
        state = Table("state", bead_axis(self.scene.N),
                      state_columns(self.state.displacement, self.state.velocity, ("bead",)))
        return (*self.run.tables(), state)

    def attributes(self) -> dict[str, Attribute]:
        """The attributes of its run, with the regime of the steady state."""
        return {**self.run.attributes(), "regime": json.dumps(self.regime.to_json())}

    def summary(self) -> list[str]:
        """Regime, largest forces and errors."""
        return [self.regime.sentence, *self.run.summary()[1:]]
