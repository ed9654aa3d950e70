"""The table of methods: what each is, what it may be used for, how fine it runs for an accuracy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import unknown_name
from ..lower import Lowered


@dataclass(frozen=True)
class Method:
    """One way to integrate.

    `order_smooth` holds where no contact opens or closes, `order` across contact events over the accuracies it is used
    for, `order_with_cut` where tension is cut: only the certified method ends its steps at the force's kink, F = 0. All
    are measured, the least of the damping laws, for adaptive methods per mean step (tests/numerics/test_orders.py).
    `variables` are "uw" or "uv".
    """

    name: str
    title: str
    order_smooth: float
    order: float
    events: bool
    adaptive: bool
    symplectic: bool
    restrictions: str
    reference: str
    variables: str = "uw"
    order_with_cut: float = 1.0


#: Smallest tolerance of a step that is still followed by a finer one.
_SMALLEST = 1e-15


@dataclass(frozen=True)
class Setting:
    """A method with its fineness: `refine` times the live method's steps, or a relative tolerance per step."""

    method: str
    refine: float = 1
    tolerance: float = 0.0

    def finer(self) -> Setting:
        """The next finer setting: half the step, or a tolerance so much smaller that the error surely is.

        With error control the error does not fall evenly with the tolerance: an eighth of it sometimes left the error
        unchanged, so the next tolerance is a sixty-fourth.
        """
        if METHODS[self.method].adaptive:
            return Setting(self.method, 1, min(max(self.tolerance / 64.0, _SMALLEST), self.tolerance / 8.0))
        return Setting(self.method, 2 * self.refine)

    def finer_than(self, lowered: Lowered, samples: int) -> Setting:
        """The next finer setting with other steps: where samples set their number, twice as fine may be as fine."""
        finer = self.finer()
        if not METHODS[self.method].adaptive:
            while finer.steps_per_period(lowered, samples) == self.steps_per_period(lowered, samples):
                finer = finer.finer()
        return finer

    @property
    def finest(self) -> bool:
        """Whether rounding would eat what a finer setting could gain."""
        return self.tolerance < 2e-15 if METHODS[self.method].adaptive else self.refine >= 256

    def steps_per_period(self, lowered: Lowered, samples: int) -> int:
        """Steps in one period for a fixed-step method, a multiple of `samples`."""
        return math.ceil(self.refine * lowered.steps_per_period(samples) / samples) * samples


METHODS: dict[str, Method] = {
    m.name: m
    for m in (
        Method("rk4", "RK4 in w", 4.0, 2.0, False, False, False, "fixed step; order 2 at contact events; a touch "
               "shorter than a step is not resolved, its jump read off the step's ends",
               "Kutta 1901; w-variables: docs/model.md"),
        Method("rk4-split", "RK4 in w, steps split at contact events, quadrature corrected there", 4.0,
               3.9, True, False, False, "fixed step; order 3.5 below errors of about 1e-9; with more than 30 beads two "
               "changes of one contact inside a step are not seen",
               "Kutta 1901; w-variables and events: docs/model.md"),
        Method("rk4-naive", "RK4 in (u, v), as one would write it first", 4.0, 1.0, False, False, False,
               "no energy account; erratic where a dashpot contact opens or closes; touches as with rk4",
               "Kutta 1901", "uv"),
        Method("verlet-naive", "velocity Verlet in (u, v), as one would write it first", 1.0, 1.0, False, False, True,
               "no energy account; symplectic, and of order 2, without damping only; touches as with rk4",
               "Verlet 1967; Swope et al. 1982", "uv"),
        Method("dop853", "Dormand–Prince 8 in w, contact events located", 8.5, 7.5, True, True, False,
               "accuracy to about 1e-12", "Hairer, Nørsett & Wanner 1993, section II.5", order_with_cut=7.5),
    )
}

#: Above this relative error the live method is the cheaper one; its error at the live step is about that below, and
#: falls with the fourth power of the step (`granchain accuracy sec2` measures both).
_LIVE_IS_CHEAPER, _LIVE_ERROR = 1e-10, 7e-6
#: Factor by which one random scene in about a thousand exceeds the usual error (`python -m tests.numerics.honesty`).
_SPREAD = 8.0
#: A largest force stands at a jump if the largest jump is at least this part of it.
AT_A_JUMP = 0.95
#: Quadrature error of ∫ s^{3/2} in units of h^{5/2}: 0.0024 over the step behind an onset, for several contacts.
_JUMP = 0.01
#: Coarsest steps for one of the live method's.
_COARSEST = 0.5


def method_for(accuracy: float, tension_cut: bool = False) -> Setting:
    """The first setting to try for a relative error of `accuracy`."""
    if accuracy >= _LIVE_IS_CHEAPER and not tension_cut:  # with a cut it is of order 1
        return Setting("rk4-split", refine=max(_COARSEST, (_LIVE_ERROR / accuracy) ** 0.25))
    return Setting("dop853", tolerance=min(1e-3, 0.1 * accuracy))


def typical_error(setting: Setting) -> float:
    """The relative error that few scenes exceed with this setting; 0 for methods of which none is known."""
    if METHODS[setting.method].adaptive:
        return _SPREAD * setting.tolerance
    return _SPREAD * _LIVE_ERROR / setting.refine**4 if setting.method == "rk4-split" else 0.0


def jump_errors(setting: Setting, lowered: Lowered, samples: int, jumps: np.ndarray, tops: np.ndarray) -> np.ndarray:
    """Lower bounds (3,) of the relative errors of the largest forces where these are at jumps (2,) [scaled].

    The quadrature error behind an onset is subtracted at the end of the split step and of the next two steps. If
    another contact closes in between, its rate is off by a part of K v^{3/2} h^{5/2} (contact_events.py), with v the
    approach speeds. Its sign changes with the step size, so the difference of two computations does not bound it.
    """
    least = np.zeros(3)
    if setting.method == "rk4-split" and lowered.slots.dissipation is not None:
        chain, step = lowered.slots.chain, lowered.period / setting.steps_per_period(lowered, samples)
        speeds = np.sqrt(jumps / lowered.slots.dissipation.coefficient)
        at_jump = jumps > AT_A_JUMP * tops[:2]
        least[:2] = at_jump * _JUMP * step**2.5 * speeds * chain.stiffness.max() * chain.inverse_mass.max()
    return least


def setting_of(name: str, accuracy: float) -> Setting:
    """The first setting of the method called `name` for `accuracy`; `BadInput` for a method that does not exist."""
    if name not in METHODS:
        raise unknown_name("method", name, METHODS)
    return Setting(name, tolerance=0.1 * accuracy) if METHODS[name].adaptive else Setting(name)
