"""Pictures of a settling chain: the motion so far, and finally its refined periodic orbit with an error.

Motions that are not periodic are recorded by the fixed-step method, without a claim on their error.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace

import numpy as np

from ...integrate import Counts, Engine, Setting, State, fixed_step_setting
from ...integrate.methods import typical_error
from ...kernels.samples import Samples
from ...regime import Regime
from ...result import Cost, Run, run_from
from ...scene import Scene
from ...state import rest
from ...stop import Stop
from ...tables import Labelled, Table, bead_axis
from ...tables.provenance import Attribute
from ...tables.words import state_columns
from ..orbit_errors import errors_between
from .relax import relax
from .settling import Settling, run_until_settled

#: Samples a period of a picture.
PICTURE_SAMPLES = 96
#: Periods shown of a motion that is not periodic.
_SHOWN = 4
#: Finest steps for a motion without a drive: how many of them take the place of one default step.
_MOST_REFINED = 64
#: Time after which a first picture is shown although nothing is decided yet [s].
_PREVIEW_AFTER = 0.012


@dataclass(frozen=True, eq=False)
class Settled(Labelled):
    """A steady state, or the motion when settling ended.

    Attributes
    ----------
    run : Run
        The recorded orbit, or a few periods where the motion is not periodic.
    regime : Regime
        What kind of motion it is.
    state : State
        Where the chain is at drive phase 0.
    start : str
        Where the motion came from: "rest" or "previous state".
    preview : bool
        Whether this is a first picture by the fixed-step method.
    final : bool
        Whether it is the last and best.

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
    start: str
    preview: bool
    final: bool

    @property
    def scene(self) -> Scene:
        """The chain."""
        return self.run.scene

    def tables(self) -> tuple[Table, ...]:
        """The tables of its run, and `state`, where the chain is at drive phase 0."""
        state = Table("state", bead_axis(self.scene.N),
                      state_columns(self.state.displacement, self.state.velocity, ("bead",)))
        return (*self.run.tables(), state)

    def attributes(self) -> dict[str, Attribute]:
        """Those of its run; `regime` and `start` are its own."""
        return {**self.run.attributes(), "regime": json.dumps(asdict(self.regime)), "start": self.start}

    def summary(self) -> list[str]:
        """Regime, largest forces and errors."""
        return [self.regime.sentence, *self.run.summary()[1:]]


def settling(scene: Scene, start: State | None = None, samples: int = PICTURE_SAMPLES,
             stop: Stop | None = None) -> Iterator[Settled]:
    """Successive pictures of a settling chain: a quick preview first, the refined steady state last.

    Parameters
    ----------
    scene : Scene
        The chain.
    start : State, optional
        Where the motion begins; at rest if not given.
    samples : int
        Samples a drive period of each picture.
    stop : Stop, optional
        Ends the computation when another thread sets it.

    Yields
    ------
    Settled
        About ten a second; `final` is set on the last.

    Raises
    ------
    NumbersFailed
        The motion is no longer finite.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import scene, settling
    >>> [picture.final for picture in settling(scene("sec2").evolve(N=2, f=2000.0))][-1]
    True
    """
    origin = "rest" if start is None else "previous state"
    began = time.perf_counter()
    if not scene.is_driven:
        yield from_start(scene, start, samples, began, stop)
        return
    motion = Settling(scene, start, stop)
    motion.run(_PREVIEW_AFTER)
    while not motion.decided:
        yield live_picture(motion, samples, began, origin, final=False)
        motion.go_on(0.1)
    if motion.regime.name == "periodic":
        yield orbit_picture(motion, samples, began, origin)
    else:
        yield live_picture(motion, samples, began, origin, final=True)


def settled(scene: Scene, start: State | None = None, samples: int = PICTURE_SAMPLES,
            stop: Stop | None = None) -> Settled:
    """The steady state of a chain; `settle` and `settled` are the same function.

    The fixed-step method runs until the distance to the orbit is bounded or the regime is decided otherwise; a periodic
    orbit is then computed again with a setting fine enough for the accuracy asked for (docs/design.md, "Settled is a
    bound").

    Parameters
    ----------
    scene : Scene
        The chain.
    start : State, optional
        Where the motion begins; at rest if not given.
    samples : int
        Samples a drive period of the recorded orbit.
    stop : Stop, optional
        Ends the computation when another thread sets it.

    Returns
    -------
    Settled
        One orbit where the motion is periodic, else a few periods of it.

    Raises
    ------
    NumbersFailed
        The motion is no longer finite.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import scene, settle
    >>> found = settle(scene("sec2").evolve(N=2, f=2000.0))
    >>> found.regime.name, found.regime.period
    ('periodic', 1)
    >>> f"{found.run.max_output_force_elastic:.3f} N"
    '2.260 N'
    """
    began = time.perf_counter()
    if not scene.is_driven:
        return from_start(scene, start, samples, began, stop)
    motion = run_until_settled(scene, start, stop)
    origin = "rest" if start is None else "previous state"
    if motion.regime.name == "periodic":
        return orbit_picture(motion, samples, began, origin)
    return live_picture(motion, samples, began, origin, final=True)


def from_start(scene: Scene, start: State | None, samples: int, began: float, stop: Stop | None) -> Settled:
    """The motion of a chain without a drive from its start, over the time 1/f, to the accuracy asked for."""
    begin, setting, total = rest(scene) if start is None else start, fixed_step_setting(), Counts()

    def recorded(chosen: Setting) -> tuple[Engine, Samples]:
        engine = Engine(scene, chosen, samples, stop=stop)
        engine.start(begin)
        rows = engine.record(samples)
        total.array += engine.counts.array
        return engine, rows

    coarse, before = recorded(setting)
    while True:
        setting = setting.finer_than(coarse.scaled, samples)
        fine, rows = recorded(setting)
        largest = float(np.abs(rows.displacement).max())
        change = float(np.abs(rows.displacement - before.displacement).max()) / largest if largest > 0 else 0.0
        if change <= scene.accuracy or setting.refine >= _MOST_REFINED:
            break
        coarse, before = fine, rows
    regime, cost = Regime.undriven(1), Cost.of(time.perf_counter() - began, total, setting.method)
    forces = errors_between(fine, coarse.maxima, 0.0, 0.0)
    run = run_from(fine, rows, 0, regime, max(change, typical_error(setting)), cost, force_errors=forces)
    return Settled(run, regime, begin, "rest" if start is None else "previous state", False, True)


def live_picture(motion: Settling, samples: int, began: float, origin: str, final: bool) -> Settled:
    """The present motion by fixed steps, over one orbit or a few periods; the settling itself is not advanced."""
    engine = Engine(motion.scene, motion.engine.setting, samples, stop=motion.stop)
    state = motion.engine.state
    engine.start(state)
    shown = motion.regime.period or _SHOWN
    record = engine.record(shown * samples)
    engine.counts.array += motion.engine.counts.array
    cost = Cost.of(time.perf_counter() - began, engine.counts, engine.setting.method)
    run = run_from(engine, record, 0, motion.regime, None, cost)
    return Settled(run, motion.regime, state, origin, not final, final)


def orbit_picture(motion: Settling, samples: int, began: float, origin: str) -> Settled:
    """The periodic orbit by the finer method, with its error: integration plus distance from the orbit.

    An error e of the n-period map moves its fixed point by e/(1 − |μ|).
    """
    n = motion.regime.period
    assert n is not None
    engine, distance = relax(motion, motion.scene.accuracy, samples)
    start = engine.state
    fine = Engine(motion.scene, engine.setting.finer(), samples, stop=motion.stop)
    fine.start(start)
    record = fine.record(n * samples)
    coarse = Engine(motion.scene, engine.setting, samples, stop=motion.stop)
    coarse.start(start)
    other = coarse.record(n * samples)
    largest = float(np.abs(record.displacement).max())
    integration = float(np.abs(record.displacement - other.displacement).max()) / largest if largest > 0 else 0.0
    fine.counts.array += motion.engine.counts.array + engine.counts.array + coarse.counts.array
    cost = Cost.of(time.perf_counter() - began, fine.counts, fine.setting.method)
    regime = replace(motion.regime, distance=distance)
    integration /= 1.0 - motion.regime.contraction
    forces = errors_between(fine, coarse.maxima, motion.regime.contraction, distance)
    run = run_from(fine, record, 0, regime, integration + distance, cost, force_errors=forces)
    return Settled(run, regime, start, origin, False, True)
