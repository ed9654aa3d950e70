"""A long period is computed in parts, with the same result, and ends soon after the stop flag is set."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import Cancelled, Scene, Stop, scene
from granchain_core.integrate import METHODS, Engine, MethodSetting, fixed, fixed_step_setting

SHORT = scene("sec2")
LONG = scene("sec2").evolve(N=200)


def motion(chain: Scene, samples: int) -> dict[str, np.ndarray]:
    """Run a chain for three periods, and record 2 · `samples` + 1 further samples."""
    engine = Engine(chain, fixed_step_setting(), samples, account=True)
    strobes, maxima = engine.periods(3)
    recorded = engine.record(2 * samples + 1)
    return {"strobes": strobes, "maxima": maxima, "displacement": recorded.displacement, "force": recorded.force,
            "energy": recorded.energy, "closings": engine.closings.copy(), "last": engine.y.copy()}


@pytest.mark.parametrize("chain", [SHORT, LONG], ids=["11 beads", "200 beads"])
@pytest.mark.parametrize("steps", [7, 40, 500])
def test_periods_in_parts_equal_whole_periods(chain: Scene, steps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Vectors restart where a part begins, so results agree up to rounding, and largest forces up to their
    interpolation.
    """
    whole = motion(chain, 4)
    monkeypatch.setattr(fixed, "steps_in_part", lambda _: steps)
    parts = motion(chain, 4)
    for name, values in whole.items():
        bound = 1e-6 if name == "maxima" else 1e-10
        assert np.abs(parts[name] - values).max(initial=0.0) <= bound * max(1e-300, np.abs(values).max(initial=0.0)), name


class Counting(Stop):
    """A stop that counts the pauses."""

    __slots__ = ("pauses",)

    def __init__(self) -> None:
        super().__init__()
        self.pauses = 0

    def pause(self) -> None:
        """Count a pause."""
        self.pauses += 1


@pytest.mark.parametrize("chain", [scene("sec2").evolve(N=2000, A0=1e-5), scene("sec2").evolve(f=0.5)], ids=["long", "slow"])
def test_a_computation_pauses_within_a_period(chain: Scene) -> None:
    stop = Counting()
    Engine(chain, fixed_step_setting(), 1, stop=stop).periods(2)
    assert stop.pauses > 4
    engine = Engine(chain, fixed_step_setting(), 2, stop=stop)
    before = stop.pauses
    engine.record(2)
    assert stop.pauses > before + 2


def test_a_long_chain_ends_a_part_after_the_flag_is_set() -> None:
    """4096 steps of 10,000 beads would take seconds; the flag, set in the fourth pause, ends the part that follows."""
    class Fourth(Counting):
        __slots__ = ()

        def pause(self) -> None:
            super().pause()
            if self.pauses == 4:
                self.set()

    stop = Fourth()
    engine = Engine(scene("sec2").evolve(N=10_000, A0=1e-4), fixed_step_setting(), 1, stop=stop)
    with pytest.raises(Cancelled):
        engine.periods(2)  # of 856 steps, in parts of 52
    assert stop.pauses == 4
    assert engine.counts.steps <= 5 * fixed.steps_in_part(engine.scaled.bodies)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("call", ["record", "periods"])
def test_a_cancelled_call_leaves_the_chain_where_the_call_began(method: str, call: str) -> None:
    """The flag is set after some steps of the call; the engine then continues like one that was not cancelled."""
    class Second(Counting):
        __slots__ = ()

        def pause(self) -> None:
            super().pause()
            self.flag[0] = self.pauses == 2  # the first pause is before the call of the kernel

    stop = Second()
    stop.pauses = 2
    first = 0 if call == "periods" else 3
    cancelled, other = (Engine(scene("sec2"), MethodSetting(method, tolerance=1e-8), 8, stop=one) for one in (stop, Stop()))
    for engine in (cancelled, other):
        engine.record(8 + first)
    before, _ = cancelled.state, other.state  # reading the state moves the driver to its place
    here = cancelled.y.copy()
    stop.pauses = 1
    with pytest.raises(Cancelled):
        getattr(cancelled, call)(4)
    assert np.array_equal(cancelled.y, here) and cancelled.elapsed == other.elapsed
    assert cancelled.state.phase == before.phase and np.array_equal(cancelled.state.velocity, before.velocity)
    assert np.array_equal(getattr(cancelled, call)(4)[0], getattr(other, call)(4)[0])
