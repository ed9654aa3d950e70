"""The table of integration methods: orders, restrictions and costs, and the step or tolerance for an accuracy."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..inputs.checks import unknown_name
from ..kernels.naive import Rk4Naive, VerletNaive
from ..kernels.rk4.step import Rk4, Rk4Split
from ..scene.hertz import EXPONENT
from ..scene.laws import LAWS
from .dop853 import Dop853Stepper
from .dop853_root import Dop853RootStepper
from .fixed import SHORT_CHAIN, FixedStep, FixedStepInVelocity
from .scaling import ScaledChain
from .stepper import Stepper

#: Fixed steps split at contact events: the method for pictures, curves and moderate accuracy.
RK4_SPLIT = "rk4-split"
#: Error control with located events: the method for the highest accuracy.
DOP853 = "dop853"

#: Above this relative error, the fixed-step method is cheaper than dop853 (`granchain accuracy sec2` measures it).
FIXED_STEP_CHEAPER_ABOVE = 1e-10
#: The usual relative error of the fixed-step method at the default step.
_FIXED_STEP_ERROR = 7e-6
#: About one random scene in a thousand has an error larger than this factor times the usual one (`python -m
#: tests.numerics.stated_errors`).
_ERROR_SPREAD = 8.0
#: dop853's first tolerance per step, as a part of the requested accuracy: errors of steps add up.
_TOLERANCE_PER_ACCURACY = 0.1
#: dop853's largest first tolerance per step, whatever accuracy is requested.
_LARGEST_TOLERANCE = 1e-3
#: Smallest sixty-fourth of a tolerance (`MethodSetting.finer`).
_SMALLEST_TOLERANCE = 1e-15
#: Tolerance below which rounding prevents any further gain.
_FINEST_TOLERANCE = 2e-15
#: dop853's tolerance for following a chain with tension cut. The distance between neighbouring trajectories, 1e-8 for a
#: Lyapunov exponent, must be far above the method's errors: with 1e-9, they changed exponents by 5e-3.
_FOLLOWING_TOLERANCE = 1e-11
#: Refinement of the fixed-step method from which rounding prevents any further gain.
_FINEST_REFINEMENT = 256


@dataclass(frozen=True)
class MethodSetting:
    """A method and its resolution: `refine` times the fixed-step method's steps, or a relative tolerance per step."""

    method: str
    refine: float = 1
    tolerance: float = 0.0

    def finer(self) -> MethodSetting:
        """Return the next finer setting: half the step, or a tolerance small enough to reduce the error in practice.

        With error control, the error does not fall regularly with the tolerance. An eighth of the tolerance sometimes
        left the error unchanged, so the next tolerance is a sixty-fourth, at least 1e-15; but always at most an eighth.
        """
        if METHODS[self.method].error_control:
            finer = min(max(self.tolerance / 64.0, _SMALLEST_TOLERANCE), self.tolerance / 8.0)
            return MethodSetting(self.method, 1, finer)
        return MethodSetting(self.method, 2 * self.refine)

    def finer_than(self, scaled: ScaledChain, samples: int) -> MethodSetting:
        """Return the next finer setting that has more steps after rounding up to a multiple of the samples."""
        finer = self.finer()
        if not METHODS[self.method].error_control:
            while finer.steps_per_period(scaled, samples) == self.steps_per_period(scaled, samples):
                finer = finer.finer()
        return finer

    @property
    def finest(self) -> bool:
        """Whether a finer setting gains nothing because of rounding."""
        if METHODS[self.method].error_control:
            return self.tolerance < _FINEST_TOLERANCE
        return self.refine >= _FINEST_REFINEMENT

    def steps_per_period(self, scaled: ScaledChain, samples: int) -> int:
        """Return the steps per period of a fixed-step method, a multiple of `samples`."""
        return math.ceil(self.refine * scaled.steps_per_period(samples) / samples) * samples

    def step(self, scaled: ScaledChain, samples: int) -> float:
        """Return the step of a fixed-step method, in scaled units."""
        return scaled.period / self.steps_per_period(scaled, samples)


@dataclass(frozen=True)
class StepCost:
    """Seconds per accepted step: `fixed`, plus `per_contact` for each contact, rejected steps included.

    For error control: `steps_per_time` steps per unit of scaled time at tolerance 1e-8, growing as
    tolerance^(−`power`). Measured on `sec2` and `rig`.
    """

    fixed: float
    per_contact: float
    steps_per_time: float = 0.0
    power: float = 0.0


@dataclass(frozen=True)
class MakeStepper:
    """Makes a method's `Stepper` from a setting, a scaled chain and the samples per period.

    `has_account` says whether the stepper's equations and kernels support the energy account.
    """

    make: Callable[[MethodSetting, ScaledChain, int], Stepper]
    has_account: bool = True

    def __call__(self, setting: MethodSetting, scaled: ScaledChain, samples: int) -> Stepper:
        """Make the stepper."""
        return self.make(setting, scaled, samples)


@dataclass(frozen=True)
class Method:
    """A method of integration: a row of `METHODS`.

    Theoretical and observed orders are the smallest over all damping laws; docs/method.md derives the theoretical ones.
    `tests/numerics/test_orders.py` measures both, for methods with error control with respect to the mean step.

    Attributes
    ----------
    name, title : str
        Its name on the command line, and in tables.
    order, order_at_events : float
        Theoretical orders with damping: where no contact opens or closes, and across contact events.
    observed_smooth, observed_order, observed_with_cut : float
        Observed orders where no contact opens or closes; across contact events, at the accuracies for which the method
        is used; and with tension cut (NaN if not measured, or if the method refuses the cut). Methods run by
        `run_error_controlled` end their steps at the kink of a cut force, F = 0.
    error_control : bool
        Whether error control chooses the steps.
    symplectic : bool
        Whether it is symplectic without damping.
    restrictions, reference : str
        Its restrictions; its source.
    stepper : MakeStepper
        Makes the method's `Stepper`, and says whether it supports the energy account.
    cost : StepCost
        Time of a step.
    usual_error : float
        Relative error at the default step, or in units of the tolerance; 0 if unknown.
    converges_regularly : bool
        Whether the error falls by the method's order at every refinement, with or without contact events.
    naive : bool
        Whether it is an obvious first attempt, which the accuracy page shows as an example of what goes wrong.
    """

    name: str
    title: str
    order: float
    order_at_events: float
    observed_smooth: float
    observed_order: float
    error_control: bool
    symplectic: bool
    restrictions: str
    reference: str
    stepper: MakeStepper
    cost: StepCost
    usual_error: float = 0.0
    converges_regularly: bool = False
    naive: bool = False
    observed_with_cut: float = math.nan

    @property
    def has_account(self) -> bool:
        """Whether its equations and kernels support the energy account."""
        return self.stepper.has_account


def _fixed(kind: Any, simd: bool = False) -> MakeStepper:
    """Return what makes the stepper of a method with fixed steps in (u, w)."""
    return MakeStepper(lambda setting, scaled, samples: FixedStep(kind(setting.steps_per_period(scaled, samples)),
                                                                  scaled, samples, simd))


def _in_velocity(kind: Any) -> MakeStepper:
    """Return what makes the stepper of a method with fixed steps in (u, v), which keeps no energy account."""
    return MakeStepper(lambda setting, scaled, samples: FixedStepInVelocity(
        kind(setting.steps_per_period(scaled, samples)), scaled, samples), has_account=False)


def _error_controlled(kind: Any, has_account: bool = True) -> MakeStepper:
    """Return what makes the stepper of a method with error control."""
    return MakeStepper(lambda setting, scaled, samples: kind(setting.tolerance, scaled, samples), has_account)


#: The order that error control guarantees for DOP853: its error estimate is ∝ h⁸ in each of the 1/h steps. Where the
#: motion is smooth, errors are ∝ h⁹; in the few steps next to an event they are as large as the estimate.
_CONTROLLED_ORDER = 7.0
#: The smallest exponent a of the damping laws: their forces λ δ^a δ̇ are the least smooth terms at an event.
_LEAST_SMOOTH = min(law.exponent for law in LAWS.values())

METHODS: dict[str, Method] = {
    m.name: m
    for m in (
        Method(
            name="rk4", title="RK4 in (u, w)",
            order=4.0, order_at_events=min(2.0 + _LEAST_SMOOTH, 1.0 + EXPONENT),
            observed_smooth=4.0, observed_order=2.0,
            error_control=False, symplectic=False,
            restrictions="fixed step; order 2 at contact events; a touch shorter than a step is not resolved, and the "
                         "jump of its force is computed from the ends of the step",
            reference="Kutta 1901; w-variables: docs/model.md", stepper=_fixed(Rk4), cost=StepCost(350e-9, 35e-9),
            observed_with_cut=1.0),
        Method(
            name=RK4_SPLIT, title="RK4 in (u, w), steps split at contact events, quadrature corrected there",
            order=4.0, order_at_events=2.0 + EXPONENT, observed_smooth=4.0, observed_order=3.9,
            error_control=False, symplectic=False,
            restrictions="fixed step; order 3.5 below errors of about 1e-9, and 1 where tension is cut; in chains of "
                         f"more than {SHORT_CHAIN} beads two events of one inner contact within a step are missed",
            reference="Kutta 1901; w-variables and events: docs/method.md", stepper=_fixed(Rk4Split, simd=True),
            cost=StepCost(450e-9, 45e-9), usual_error=_FIXED_STEP_ERROR, converges_regularly=True,
            observed_with_cut=1.0),
        Method(
            name="rk4-naive", title="RK4 in (u, v), the obvious first attempt",
            order=4.0, order_at_events=1.0 + _LEAST_SMOOTH, observed_smooth=4.0, observed_order=1.0,
            error_control=False, symplectic=False,
            restrictions="no energy account; its error is irregular where a contact with a dashpot opens or closes; "
                         "touches as with rk4",
            reference="Kutta 1901", stepper=_in_velocity(Rk4Naive), cost=StepCost(120e-9, 40e-9), naive=True),
        Method(
            name="verlet-naive", title="velocity Verlet in (u, v), the obvious first attempt",
            order=1.0, order_at_events=1.0, observed_smooth=1.0, observed_order=1.0,
            error_control=False, symplectic=True,
            restrictions="no energy account; symplectic and of order 2 only without damping; touches as with rk4",
            reference="Verlet 1967; Swope et al. 1982", stepper=_in_velocity(VerletNaive), cost=StepCost(80e-9, 12e-9),
            naive=True),
        Method(
            name=DOP853, title="DOP853, Dormand–Prince 8(5,3), in (u, w), contact events located",
            order=8.0, order_at_events=_CONTROLLED_ORDER, observed_smooth=8.5, observed_order=7.5,
            error_control=True, symplectic=False, restrictions="errors down to about 1e-12",
            reference="Hairer, Nørsett & Wanner 1993, section II.5", stepper=_error_controlled(Dop853Stepper),
            cost=StepCost(2.5e-6, 480e-9, steps_per_time=5.0, power=0.1), usual_error=1.0, observed_with_cut=7.5),
        Method(
            name="dop853-root", title="DOP853 in (u, w), in the root of an overlap next to contact events",
            order=8.0, order_at_events=_CONTROLLED_ORDER, observed_smooth=8.0, observed_order=7.0,
            error_control=True, symplectic=False,
            restrictions=f"errors down to about 1e-12; no energy account; only chains of up to {SHORT_CHAIN} beads, "
                         "with a driver that is harmonic or at rest, and without tension cut",
            reference="Hairer, Nørsett & Wanner 1993, section II.5; the root of an overlap: docs/method.md",
            stepper=_error_controlled(Dop853RootStepper, has_account=False),
            cost=StepCost(500e-9, 20e-9, steps_per_time=4.0, power=0.1), usual_error=1.0),
    )
}

#: A largest force counts as being at a jump if the largest jump is at least this part of it.
AT_A_JUMP = 0.95
#: Quadrature error of ∫ s^{3/2} in units of h^{5/2}: 0.0024 over the step after a closing, with room for several
#: contacts.
_JUMP_ERROR = 0.01
#: Smallest refinement: steps twice as long as the fixed-step method's own.
_COARSEST_REFINEMENT = 0.5


def fixed_step_setting(refine: float = 1) -> MethodSetting:
    """Return the fixed-step method with `refine` times the default steps."""
    return MethodSetting(RK4_SPLIT, refine)


def dop853_setting(tolerance: float = 0.0) -> MethodSetting:
    """Return dop853 with a relative tolerance per step."""
    return MethodSetting(DOP853, tolerance=tolerance)


def following_setting(tension_cut: bool) -> MethodSetting:
    """Return the setting for following a chain, to a steady state or through a section, where no accuracy is requested.

    With tension cut, the fixed-step method has order 1. At its default step, its error is about one per cent, it
    converges to cycles that do not exist, and it may lead to another attractor. A curve takes no longer with dop853.
    """
    return dop853_setting(_FOLLOWING_TOLERANCE) if tension_cut else fixed_step_setting()


def method_for(accuracy: float, tension_cut: bool = False) -> MethodSetting:
    """Return the first setting to try for a relative error of `accuracy`."""
    if accuracy >= FIXED_STEP_CHEAPER_ABOVE and not tension_cut:  # with tension cut, the fixed-step method has order 1
        # the order without events, 4, instead of the observed order of `typical_error`: a guess that halvings refine
        return fixed_step_setting(max(_COARSEST_REFINEMENT, (_FIXED_STEP_ERROR / accuracy) ** 0.25))
    return dop853_setting(_first_tolerance(accuracy))


def _first_tolerance(accuracy: float) -> float:
    return min(_LARGEST_TOLERANCE, _TOLERANCE_PER_ACCURACY * accuracy)


def typical_error(setting: MethodSetting) -> float:
    """Return the relative error that few scenes exceed with this setting; 0 for methods for which none is known.

    With fixed steps, it falls by the observed order: of 80 random chains, 13 to 21 exceed it at 1 to 32 times the
    default steps, most of them chaotic. By the theoretical order where no contact opens or closes, it would be 15 to
    25.
    """
    method = METHODS[setting.method]
    if method.error_control:
        return _ERROR_SPREAD * method.usual_error * setting.tolerance
    return _ERROR_SPREAD * method.usual_error / setting.refine**method.observed_order


def jump_errors(setting: MethodSetting, scaled: ScaledChain, step: float, jumps: np.ndarray,
                maxima: np.ndarray) -> np.ndarray:
    """Return lower limits (3,) of the stated relative errors of largest forces that are at jumps (2,).

    All in scaled units.

    At the end of a step that was split at a closing, the quadrature errors of this step and of the next two are
    subtracted, the latter before they arise. If another contact closes in between, its momentum is off by a fraction of
    K v^{3/2} h^{5/2} (contact_events.py). The relative error of its rate v is therefore a fraction of K √v h^{5/2}/m.
    The sign changes with the step size, so the difference of two computations does not bound this error.
    """
    errors = np.zeros(3)
    if setting.method == RK4_SPLIT and scaled.slots.dissipation is not None:
        chain = scaled.slots.chain
        root_speeds = np.sqrt(jumps / scaled.slots.dissipation.coefficient)
        at_jump = jumps > AT_A_JUMP * maxima[:2]
        hardest = chain.stiffness.max() * chain.inverse_mass.max()
        errors[:2] = at_jump * _JUMP_ERROR * step ** (EXPONENT + 1.0) * root_speeds * hardest
    return errors


def setting_of(name: str, accuracy: float) -> MethodSetting:
    """Return the first setting of the method `name` for `accuracy`; raise `BadInput` for an unknown method.

    A method with fixed steps begins with its default steps, because for most of them no usual error is known.
    """
    if name not in METHODS:
        raise unknown_name("method", name, METHODS)
    if METHODS[name].error_control:
        return MethodSetting(name, tolerance=_first_tolerance(accuracy))
    return MethodSetting(name)
