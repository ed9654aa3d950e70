"""Every method has at least its theoretical order for every smoothness of the forces, and the order that it states.

A measured order is the slope of a straight line through log error over log step, over at least three decades of error
if the method is of order 2 or more. Errors are averaged over several scenes (geometric mean), since in a single scene
they depend on where in a step the contact events fall.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.integrate import METHODS, Engine, MethodSetting
from granchain_core.scene.laws import LAWS

PERIODS = 3
REFINED = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32)
TOLERANCES = 10.0 ** np.arange(-4, -12.5, -1)
#: A fit over a few decades may be this much below the order in the limit.
ORDER_SLACK = 0.2
#: The row of a method with fixed steps states what is measured to within this much: neither more nor less.
ORDER_BAND = 0.3
_FREQUENCIES = (340.0, 470.0, 615.0, 900.0, 1130.0, 1576.0)
#: Kinds of right-hand sides: no contact opens; contacts without damping; with each damping law; with a tension cut.
SMOOTHNESS: dict[str, dict[str, Any]] = {
    "closed": {"F0": 5.0}, "none": {"dissipation": "none"}, **{law: {"dissipation": law} for law in LAWS},
    "cut": {"tension": "cut"},
}
#: Theoretical orders of every method (docs/method.md, below the table of orders). Each is a lower bound: at the coarser
#: steps, a smoother part of the error may still dominate.
THEORY = {
    ("rk4-split", "closed"): 4.0, ("rk4-split", "none"): 3.5, **{("rk4-split", law): 3.5 for law in LAWS},
    ("rk4", "closed"): 4.0, ("rk4", "none"): 2.5,
    **{("rk4", name): min(2.0 + law.exponent, 2.5) for name, law in LAWS.items()},
    ("rk4", "cut"): 1.0, ("rk4-split", "cut"): 1.0,
    ("rk4-naive", "closed"): 4.0, ("rk4-naive", "none"): 2.5, ("rk4-naive", "linear"): 1.0,
    ("verlet-naive", "closed"): 1.0, ("verlet-naive", "none"): 2.0, ("verlet-naive", "linear"): 1.0,
    ("dop853-root", "closed"): 8.0, ("dop853-root", "none"): 7.0, **{("dop853-root", law): 7.0 for law in LAWS},
    ("dop853", "closed"): 8.0, ("dop853", "none"): 7.0, **{("dop853", law): 7.0 for law in LAWS}, ("dop853", "cut"): 7.0,
}
#: With a dashpot, contact events reduce the order 4 of a fixed step to less than this: the reason for w-variables and
#: for split steps.
LOST = {"rk4": 3.0, "rk4-naive": 2.0}


@functools.cache
def motion(smoothness: str, f: float, setting: MethodSetting) -> tuple[np.ndarray, int]:
    """Return eight samples per period, in scaled units, and the number of steps.

    dop853 integrates the energy account as well, as in a run, since these kernels are compiled for other tests too.
    """
    engine = Engine(scene("sec2").evolve(f=f, **SMOOTHNESS[smoothness]), setting, 8, account=METHODS[setting.method].error_control)
    return engine.record(8 * PERIODS).displacement, engine.counts.steps


def frequencies(smoothness: str) -> tuple[float, ...]:
    """Return the drive frequencies; without damping, only the fast ones, whose motion is not yet sensitive after three
    periods.
    """
    return _FREQUENCIES[2:] if smoothness == "none" else _FREQUENCIES


def errors(smoothness: str, settings: Sequence[MethodSetting]) -> np.ndarray:
    """Return the largest relative displacement errors (settings, scenes), compared with dop853 at 1e-14 per step."""
    found = np.empty((len(settings), len(frequencies(smoothness))))
    for j, f in enumerate(frequencies(smoothness)):
        true = motion(smoothness, f, MethodSetting("dop853", tolerance=1e-14))[0]
        for i, setting in enumerate(settings):
            found[i, j] = np.abs(motion(smoothness, f, setting)[0] - true).max() / np.abs(true).max()
    return found


@functools.cache
def order(method: str, smoothness: str) -> float:
    """Return the slope of log error over log step, over 1.5 decades of steps or eight decades of tolerance."""
    if METHODS[method].error_control:
        return order_by_tolerance(method, smoothness)
    found = errors(smoothness, [MethodSetting(method, refine=r) for r in REFINED])
    return float(-np.polyfit(np.log(REFINED), np.log(found).mean(axis=1), 1)[0])


def order_by_tolerance(method: str, smoothness: str) -> float:
    """Return the slope of log error over log mean step, over eight decades of tolerance."""
    settings = [MethodSetting(method, tolerance=t) for t in TOLERANCES]
    steps = np.array([[motion(smoothness, f, s)[1] for f in frequencies(smoothness)] for s in settings])
    error = np.log(errors(smoothness, settings)).mean(axis=1)
    return float(-np.polyfit(np.log(steps).mean(axis=1), error, 1)[0])


@pytest.mark.parametrize(("method", "smoothness"), THEORY)
def test_every_method_has_its_order_for_every_smoothness(method: str, smoothness: str) -> None:
    """It is at least the theoretical order minus 0.2 for the fit."""
    assert order(method, smoothness) >= THEORY[method, smoothness] - ORDER_SLACK


@pytest.mark.parametrize(("method", "most"), LOST.items())
def test_contact_events_take_orders_from_a_fixed_step(method: str, most: float) -> None:
    """A step across a kink or a jump has a lower order; a measurement that always found 4 would fail here."""
    assert order(method, "linear") < most


@pytest.mark.parametrize("method", METHODS)
def test_the_table_of_methods_states_what_is_measured(method: str) -> None:
    """Its orders are those measured without events, across contact events (the lowest), and with a tension cut.

    With error control they are at most those: a line fitted over tolerances may be steeper than any order (11 for
    dop853-root across events).
    """
    with_events = [smoothness for name, smoothness in THEORY if name == method and smoothness not in ("closed", "cut")]
    assert with_events, f"add rows of {method} to THEORY"
    row = METHODS[method]
    pairs = [(row.observed_smooth, order(method, "closed")),
             (row.observed_order, min(order(method, smoothness) for smoothness in with_events))]
    if (method, "cut") in THEORY:
        pairs.append((row.observed_with_cut, order(method, "cut")))
    for stated, measured in pairs:
        assert stated <= measured + ORDER_SLACK
        assert row.error_control or stated >= measured - ORDER_BAND


@pytest.mark.parametrize("method", METHODS)
def test_an_order_with_a_tension_cut_is_stated_exactly_where_it_is_measured(method: str) -> None:
    """A new row, or that of a method that refuses the cut, states none."""
    assert np.isfinite(METHODS[method].observed_with_cut) == ((method, "cut") in THEORY)


@pytest.mark.parametrize("method", METHODS)
def test_the_table_of_methods_has_the_orders_of_theory(method: str) -> None:
    """It states the order without events, and across contact events the lowest of all damping laws."""
    with_events = [found for (name, smoothness), found in THEORY.items() if name == method and smoothness in LAWS]
    assert METHODS[method].order == THEORY[method, "closed"]
    assert METHODS[method].order_at_events == min(with_events)


@pytest.mark.parametrize("smoothness", [one for one in SMOOTHNESS if one not in ("none", "cut")])
def test_error_of_dop853_follows_its_tolerance(smoothness: str) -> None:
    """The error stays below a thousand tolerances: each of about a hundred events and steps may add one tolerance, and
    the sensitivity of these motions is below 10 (reference.npz). Without damping, and with a tension cut, sensitivities
    are in the thousands.
    """
    found = errors(smoothness, [MethodSetting("dop853", tolerance=t) for t in TOLERANCES])
    assert (found.max(axis=1) < 1000 * TOLERANCES).all()
