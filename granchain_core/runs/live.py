"""A chain that keeps running while its knobs are moved."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..inputs.checks import whole_number
from ..integrate import Engine, fixed_step_setting
from ..kernels.forces.peaks import next_period
from ..results.recorded_motion import MOST_RECORDED, MOST_SAMPLES
from ..results.regime import Regime
from ..results.run import Cost, Jumps, Run, run_from, start_words
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State, checked_start, rest

LIVE_SETTING = fixed_step_setting(2)
"""The method setting of a live chain."""
_NOT_ASKED = Regime.unsettled(0)


class LiveChain:
    """A chain that keeps running while its knobs are moved, by the fixed-step method.

    New values of D, k, the laws and the frequency take effect at the next sample; the drive phase continues, so the
    driver never jumps. A new amplitude takes effect when the driver next passes its middle position, where u_0 is the
    same for every A0.

    Parameters
    ----------
    scene : Scene
        The chain.
    samples : int
        Recorded samples per drive period, an even number.
    start : State, optional
        Where the motion starts; by default at rest.
    stop : Stop, optional
        When another thread sets it, `advance` raises `Cancelled`; the chain cannot be used after that.

    Raises
    ------
    BadInput
        `samples` is not an even whole number.

    Examples
    --------
    >>> from granchain_core import LiveChain, scene
    >>> chain = scene("sec2").evolve(N=2, f=2000.0)
    >>> live = LiveChain(chain, samples=16)
    >>> live.advance(32).displacement.shape
    (33, 2)
    >>> live.change(chain.evolve(f=1900.0))
    >>> live.time == 2 / 2000.0
    True
    """

    def __init__(self, scene: Scene, samples: int = 96, start: State | None = None, stop: Stop | None = None) -> None:
        require_scene(scene)
        samples = whole_number("samples =", samples, 2, MOST_SAMPLES)
        if samples % 2:
            raise BadInput(f"samples = {samples} must be even, so that the driver's middle position is one of them; "
                           f"the nearest valid value is {samples + 1}.")
        self.stop = Stop() if stop is None else stop
        self.samples = samples
        self.scene = scene
        self.time = 0.0
        self._index = 0
        self._waiting: Scene | None = None
        self._began = start_words(scene, start)
        self._engine = self._new_engine(scene, rest(scene) if start is None else checked_start(scene, start))
        if start is not None:
            self._index = round(start.phase * samples) % samples

    def _new_engine(self, scene: Scene, state: State) -> Engine:
        engine = Engine(scene, LIVE_SETTING, self.samples, stop=self.stop)
        engine.start(state)
        return engine

    @property
    def state(self) -> State:
        """The current state of the chain."""
        return self._engine.state

    def change(self, scene: Scene) -> None:
        """Use new knobs as soon as the drive allows it; with another number of beads, the chain starts from rest."""
        require_scene(scene)
        if scene.N != self.scene.N:
            self.scene = scene
            self.reset()
            return
        at_once = scene.evolve(A0=self.scene.A0, k=scene.k)
        self._waiting = scene if scene.A0 != self.scene.A0 else None
        self._engine = self._new_engine(at_once, self._engine.state)
        self.scene = at_once

    def reset(self) -> None:
        """Return to rest at drive phase 0, with the newest knobs."""
        self.scene = self._waiting or self.scene
        self._waiting = None
        self.time, self._index, self._began = 0.0, 0, start_words(self.scene, None)
        self._engine = self._new_engine(self.scene, rest(self.scene))

    def advance(self, count: int) -> Run:
        """Advance by `count` samples: count + 1 rows, the current state first; `time` continues from call to call.

        The largest forces are those of these samples. Raises `BadInput` if `count` is not a whole number from 1,
        `ComputationError`, `Cancelled`.
        """
        count = whole_number("count =", count, 1, MOST_RECORDED // self.scene.N)
        began = time.perf_counter()
        pieces = []
        left = count
        while left > 0:
            piece = min(left, self._until_middle()) if self._waiting is not None else left
            pieces.append(self._advance_piece(piece, began))
            left -= piece
            if self._waiting is not None and self._index % (self.samples // 2) == 0:
                waiting, self._waiting = self._waiting, None
                self._engine = self._new_engine(waiting, self._engine.state)
                self.scene = waiting
        return joined(pieces) if len(pieces) > 1 else pieces[0]

    def _until_middle(self) -> int:
        half = self.samples // 2
        return half - self._index % half

    def _advance_piece(self, count: int, began: float) -> Run:
        engine, first = self._engine, self._index
        engine.counts.array[:] = 0
        next_period(engine.log.peaks)
        record = engine.record(count)
        cost = Cost.of(time.perf_counter() - began, engine.counts, engine.setting.method)
        run = run_from(engine, record, first, _NOT_ASKED, None, cost, start=self._began)
        start = self.time - float(run.time[0])
        run = replace(run, time=self.time + np.arange(count + 1) * (self.scene.period / self.samples),
                      jumps=replace(run.jumps, time=run.jumps.time + start))
        self.time = float(run.time[-1])
        self._index = (first + count) % self.samples
        return run


def joined(pieces: list[Run]) -> Run:
    """Join successive runs to one; the first row of each later piece repeats the last row of the previous one."""

    def rows(name: str) -> np.ndarray:
        return np.concatenate([getattr(p, name)[(i > 0) :] for i, p in enumerate(pieces)])

    cost = Cost(sum(p.cost.wall_s for p in pieces), steps=sum(p.cost.steps for p in pieces),
                rhs=sum(p.cost.rhs for p in pieces), events=sum(p.cost.events for p in pieces),
                method=pieces[-1].cost.method)
    return replace(
        pieces[-1], cost=cost, time=rows("time"), displacement=rows("displacement"), velocity=rows("velocity"),
        force=rows("force"), drive_displacement=rows("drive_displacement"),
        max_input_force=max(p.max_input_force for p in pieces),
        max_output_force=max(p.max_output_force for p in pieces),
        max_output_force_elastic=max(p.max_output_force_elastic for p in pieces),
        jumps=Jumps(np.concatenate([p.jumps.time for p in pieces]), np.concatenate([p.jumps.contact for p in pieces]),
                    np.concatenate([p.jumps.force for p in pieces]), sum(p.jumps.missing for p in pieces)),
    )
