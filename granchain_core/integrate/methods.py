"""The table of methods: what each is, what it may be used for, how fine it runs for an accuracy."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import unknown_name
from ..lower import Lowered


@dataclass(frozen=True)
class Method:
    """One way to integrate.

    `order` is what it keeps across contact events, `order_with_cut` what it keeps where tension is cut: the force's
    kink at F = 0 and its end at δ = 0 are no events that a fixed step is split at. `variables` are "uw" or "uv".
    """

    name: str
    title: str
    order: float
    events: bool
    adaptive: bool
    symplectic: bool
    restrictions: str
    reference: str
    variables: str = "uw"
    order_with_cut: float = 1.0


@dataclass(frozen=True)
class Setting:
    """A method with its fineness: `refine` times the live method's steps, or a relative tolerance per step."""

    method: str
    refine: int = 1
    tolerance: float = 0.0

    def finer(self) -> Setting:
        """The next finer setting: half the step, or an eighth of the tolerance."""
        if METHODS[self.method].adaptive:
            return Setting(self.method, 1, self.tolerance / 8.0)
        return Setting(self.method, 2 * self.refine)

    @property
    def finest(self) -> bool:
        """Whether rounding would eat what a finer setting could gain."""
        return self.tolerance < 2e-15 if METHODS[self.method].adaptive else self.refine >= 256

    def steps_per_period(self, lowered: Lowered, samples: int) -> int:
        """Steps in one period for a fixed-step method, a multiple of `samples`."""
        return self.refine * lowered.steps_per_period(samples)


METHODS: dict[str, Method] = {
    m.name: m
    for m in (
        Method("rk4", "RK4 in w", 2.0, False, False, False, "fixed step; order 2 at contact events",
               "Kutta 1901; w-variables: docs/model.md"),
        Method("rk4-split", "RK4 in w, steps split at contact events", 2.5, True, False, False,
               "fixed step; two changes of one contact inside a step are not seen",
               "Kutta 1901; w-variables: docs/model.md"),
        Method("rk4-naive", "RK4 in (u, v), as one would write it first", 1.0, False, False, False,
               "no energy account; erratic where a dashpot contact opens or closes", "Kutta 1901", "uv"),
        Method("verlet-naive", "velocity Verlet in (u, v), as one would write it first", 1.0, False, False, True,
               "no energy account; symplectic without damping only", "Verlet 1967; Swope et al. 1982", "uv"),
        Method("dop853", "Dormand–Prince 8 in w, contact events located", 8.0, True, True, False,
               "accuracy to about 1e-12", "Hairer, Nørsett & Wanner 1993, section II.5"),
    )
}

#: Above this relative error the live method is the cheaper one, and below it its error at the live step, which falls
#: with the power 2.5 of the step (`granchain accuracy sec2` measures both).
_LIVE_IS_CHEAPER, _LIVE_ERROR = 2e-7, 6e-6


def method_for(accuracy: float) -> Setting:
    """The first setting to try for a relative error of `accuracy`."""
    if accuracy >= _LIVE_IS_CHEAPER:
        return Setting("rk4-split", refine=max(1, round((_LIVE_ERROR / accuracy) ** 0.4)))
    return Setting("dop853", tolerance=min(1e-3, 0.1 * accuracy))


def setting_of(name: str, accuracy: float) -> Setting:
    """The first setting of the method called `name` for `accuracy`; `BadInput` for a method that does not exist."""
    if name not in METHODS:
        raise unknown_name("method", name, METHODS)
    return Setting(name, tolerance=0.1 * accuracy) if METHODS[name].adaptive else Setting(name)
