"""A pair: a chain and its observer in one integration, a drive–response pair. Model (4), Zhang et al. 2016.

The observer is a second chain with the same beads and the same wall. Its first bead feels F_in, the force of the first
chain's driver contact, instead of a contact of its own. The bodies of the pair are those of the chain, 0..N+1, then the
observer's beads and its wall; contact N+1, between the chain's wall and the observer's first bead, carries F_in.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..execution.stop import Stop
from ..integrate import Engine, dop853_setting
from ..integrate.scaling import ScaledChain, scale_chain
from ..kernels.effects.contact import Chain
from ..kernels.effects.driver import BODY_FAR_AWAY
from ..kernels.effects.given_force import ObserverCoupling
from ..kernels.effects.preload import Preload
from ..kernels.samples import Samples
from ..orbits.stroboscopic_map import TOLERANCE
from ..scene import Scene
from ..scene.state import State


def scale_pair(scene: Scene) -> ScaledChain:
    """Scale a chain with its observer: arrays and slots of both.

    The contact that carries F_in has no overlap of its own: its bodies are BODY_FAR_AWAY apart, and its stiffness is 0.
    """
    chain = scale_chain(scene)
    mass, stiffness = chain.slots.chain
    static = np.zeros(scene.N + 1) if chain.slots.preload is None else chain.slots.preload.static
    slots = chain.slots._replace(
        chain=Chain(np.concatenate([mass, mass[1:]]), np.concatenate([stiffness, [0.0], stiffness[1:]])),
        preload=Preload(np.concatenate([static, [-BODY_FAR_AWAY], static[1:]])),
        driver=ObserverCoupling(1.0, chain.beta, scene.N + 1),
    )
    return replace(chain, slots=slots)


class Pair:
    """A chain and its observer, integrated together by dop853 with `samples` samples per period.

    Both go through the same arithmetic, so an observer that starts in its chain's state remains in it, up to rounding:
    the compiler may sum the terms of a bead in another order than those of the observer's bead.
    """

    def __init__(self, scene: Scene, samples: int, stop: Stop | None = None) -> None:
        self.scene = scene
        self.engine = Engine(scene, dop853_setting(TOLERANCE), samples, stop=stop,
                             scaled=scale_pair(scene))

    def start(self, chain: State, observer: State) -> None:
        """Start both from their states, at the chain's phase."""
        def both(name: str) -> np.ndarray:
            return np.concatenate([getattr(chain, name), [0.0], getattr(observer, name)])

        self.engine.start(State(both("displacement"), both("velocity"), chain.phase))

    def difference(self, rows: Samples) -> np.ndarray:
        """Observer minus chain at recorded samples (T, 2N): displacements, then velocities, in scaled units."""
        n = self.scene.N
        return np.hstack([row[:, n + 1 :] - row[:, :n] for row in (rows.displacement, rows.velocity)])

    @property
    def states(self) -> tuple[State, State]:
        """The states of the chain and of its observer."""
        both, n = self.engine.state, self.scene.N
        return (State(both.displacement[:n], both.velocity[:n], both.phase),
                State(both.displacement[n + 1 :], both.velocity[n + 1 :], both.phase))
