"""Every method converges with the order that the table of methods claims for it, and reaches what it says."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.integrate import METHODS, Engine, Setting

#: Scenes with contacts that open and close, over a few periods; and one that always stays closed.
WITH_EVENTS = {"sec2 340 Hz": (scene("sec2"), 4), "sec2 1130 Hz": (scene("fig3b"), 6), "rig 60 Hz": (scene("rig"), 2),
               "Tsuji": (scene("sec2").evolve(dissipation="tsuji"), 3)}
CLOSED = (scene("sec2").evolve(F0=5.0), 4)
CUT = (scene("sec2").evolve(tension="cut"), 3)
FIXED = [name for name, m in METHODS.items() if not m.adaptive and m.variables == "uw"]
REFINED = (1, 2, 4, 8, 16, 32)
TOLERANCES = 10.0 ** np.arange(-4, -12.5, -1)


@functools.cache
def motion(chain, periods: int, setting: Setting) -> tuple[np.ndarray, int]:
    """Eight samples a period in scaled units, and the steps they took."""
    engine = Engine(chain, setting, 8)
    return engine.record(8 * periods).displacement, engine.counts.steps


def errors(chain, periods: int, settings) -> np.ndarray:
    """Largest displacement error of each setting, relative, against the certified method at 1e-14 per step."""
    true = motion(chain, periods, Setting("dop853", tolerance=1e-14))[0]
    return np.array([np.abs(motion(chain, periods, s)[0] - true).max() for s in settings]) / np.abs(true).max()


def fixed_order(method: str, chain, periods: int) -> float:
    """Slope of log error over log step, six halvings."""
    found = errors(chain, periods, [Setting(method, refine=r) for r in REFINED])
    return float(-np.polyfit(np.log(REFINED), np.log(found), 1)[0])


def adaptive_order(chain, periods: int) -> float:
    """Slope of log error over log mean step, eight decades of tolerance."""
    settings = [Setting("dop853", tolerance=t) for t in TOLERANCES]
    steps = [motion(chain, periods, s)[1] for s in settings]
    return float(-np.polyfit(np.log(steps), np.log(errors(chain, periods, settings)), 1)[0])


@pytest.mark.parametrize("case", WITH_EVENTS)
@pytest.mark.parametrize("method", FIXED)
def test_fixed_step_methods_keep_their_claimed_order_across_events(method, case):
    """At least the table's order less 0.3, the scatter that a fit through six uneven errors has."""
    assert fixed_order(method, *WITH_EVENTS[case]) > METHODS[method].order - 0.3


@pytest.mark.parametrize("method", FIXED)
def test_fixed_step_methods_are_of_order_4_where_no_contact_opens(method):
    """RK4 on a smooth right-hand side."""
    assert fixed_order(method, *CLOSED) == pytest.approx(4.0, abs=0.1)  # the next term is one order higher


@pytest.mark.parametrize("method", FIXED)
def test_fixed_step_methods_keep_their_claimed_order_with_a_tension_cut(method):
    """The table states another order for these: the cut's kink at F = 0 is no contact event."""
    assert fixed_order(method, *CUT) > METHODS[method].order_with_cut - 0.3


def test_certified_method_is_of_order_8_where_no_contact_opens():
    """Error over the mean step of the step control, eight decades."""
    assert adaptive_order(*CLOSED) == pytest.approx(METHODS["dop853"].order, abs=0.4)


@pytest.mark.parametrize("case", WITH_EVENTS)
def test_certified_method_keeps_a_high_order_across_events(case):
    """Steps restart at every event and start small, so the fit is uneven: within 1.5 of the table's 8."""
    assert adaptive_order(*WITH_EVENTS[case]) > METHODS["dop853"].order - 1.5


@pytest.mark.parametrize("case", [*WITH_EVENTS, "closed"])
def test_error_of_the_certified_method_follows_its_tolerance(case):
    """At every tolerance the error stays below a thousand times it: each of some hundred events and steps may add one
    tolerance, and the sensitivity of these motions is below 10 (reference.npz)."""
    chain, periods = {**WITH_EVENTS, "closed": CLOSED}[case]
    found = errors(chain, periods, [Setting("dop853", tolerance=t) for t in TOLERANCES])
    assert (found < 1000 * TOLERANCES).all()


def test_naive_methods_are_no_better_than_the_table_says():
    """In (u, v) the dashpot's jump leaves order 1, whatever the method: why the product works in w."""
    for name, method in METHODS.items():
        if method.variables == "uv":
            assert fixed_order(name, *WITH_EVENTS["sec2 340 Hz"]) == pytest.approx(method.order, abs=0.6)  # erratic
