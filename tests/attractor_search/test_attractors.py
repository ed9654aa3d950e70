"""All attractors of one setting are found from rest, sweeps and random states, each once, with shares that add up to 1.
"""

from __future__ import annotations

import sys

import numpy as np
import pytest
from scipy.stats import binomtest

from granchain_core import BadInput, ComputationError, Scene, orbit, resonance_curve, scene, settle
from granchain_core.attractor_search import Attractor, attractors, listing
from granchain_core.attractor_search.attractor import Origin
from granchain_core.attractor_search.attractors import _locks, share, share_interval
from granchain_core.attractor_search.attractors import _regime as irregular_regime
from granchain_core.attractor_search.sameness import Candidate
from granchain_core.results.regime import Regime
from granchain_core.scene.state import State, rest
from granchain_core.steady.steady_state import SteadyState

#: Frequency [Hz] at which rest, a sweep up and a sweep down lead to three different motions of sec2.
MANY = 893.0


@pytest.fixture(scope="module")
def many() -> list[Attractor]:
    return attractors(scene("sec2").evolve(f=MANY), random_states=48)


def named(found: list[Attractor], name: str) -> Attractor:
    """Return the attractor that a start leads to."""
    return next(one for one in found if name in [origin.name for origin in one.origins])


def test_rest_up_and_down_lead_to_three_attractors(many: list[Attractor]) -> None:
    rest, up, down = (named(many, name) for name in ("rest", "up", "down"))
    assert rest is not up and up is not down and rest is not down
    assert rest.regime.period == 3 and down.regime.period == 3 and up.regime.name == "quasi-periodic"
    # separately computed curves end at the same forces: periodic motions agree to the stated errors of both
    frequencies = MANY * np.linspace(0.92, 1.08, 9)
    for direction, one in (("rest", rest), ("down", down)):
        point = resonance_curve(scene("sec2"), frequencies, direction).points[4]
        assert point.force_errors.output is not None and one.force_errors.output is not None
        assert one.max_output_force == pytest.approx(point.max_output_force,
                                                     rel=point.force_errors.output + one.force_errors.output)


def test_every_start_leads_to_one_attractor_and_shares_add_up(many: list[Attractor]) -> None:
    names = [origin.name for one in many for origin in one.origins]
    assert sorted(names) == sorted(["rest", "up", "down", *(f"random {i}" for i in range(48))])
    assert sum(one.share for one in many) == pytest.approx(1.0, abs=1e-12)
    assert {one.share_of for one in many} == {"random states"}
    # 29, 19 and none of the 48 random states; a start near a boundary may change sides with the rounding
    for name, share_of_48, error in (("rest", 0.604, 0.068), ("down", 0.396, 0.068), ("up", 0.0, 0.0267)):
        assert named(many, name).share == pytest.approx(share_of_48, abs=2.1 / 48)
        assert named(many, name).share_error == pytest.approx(error, abs=0.0015)


def test_every_start_settles_alone_on_its_attractor(many: list[Attractor]) -> None:
    # `settle` does not use batches: it starts from the listed state
    for one in (named(many, "rest"), named(many, "down")):
        origin = next(o for o in one.origins if o.name.startswith("random"))
        alone = settle(one.scene, origin.state)
        assert alone.regime.period == one.regime.period
        stated = one.force_errors.output, alone.run.force_errors.output
        assert None not in stated
        assert alone.run.max_output_force == pytest.approx(one.max_output_force, rel=sum(stated))


def test_periodic_attractors_are_converged_stable_orbits(many: list[Attractor]) -> None:
    periodic = [one for one in many if one.regime.period]
    for one in periodic:
        assert one.orbit is not None and one.orbit.residual <= 1e-11 and one.stable
        assert orbit(one.scene, one.regime.period, one.state).residual <= 1e-9
    irregular = [one for one in many if not one.regime.period]
    for one in irregular:
        assert one.stable is None and one.regime.lyapunov is not None and one.force_errors.output is None


def test_the_same_seed_gives_the_same_answer_and_another_seed_the_same_attractors(many: list[Attractor]) -> None:
    def fingerprint(found: list[Attractor]) -> list[tuple]:
        return [(one.regime.name, one.regime.period, one.share, [o.name for o in one.origins]) for one in found]

    assert fingerprint(attractors(scene("sec2").evolve(f=MANY), random_states=48)) == fingerprint(many)
    other = attractors(scene("sec2").evolve(f=MANY), random_states=48, seed=1)
    assert {(one.regime.name, one.regime.period) for one in other} == {(o.regime.name, o.regime.period) for o in many}
    assert fingerprint(other) != fingerprint(many)


@pytest.mark.parametrize(("frequency", "period"), [(340.0, 1), (615.0, 2), (1130.0, 3)])
def test_shifted_copies_of_an_orbit_are_one_attractor(frequency: float, period: int) -> None:
    # an orbit of period n has n stroboscopic copies, and random states end on all of them
    found = attractors(scene("sec2").evolve(f=frequency), random_states=32)
    assert [one.regime.period for one in found] == [period] and found[0].share == 1.0


def test_an_unstable_orbit_is_not_an_attractor() -> None:
    # At 1936 Hz, a sweep down arrives at a period-1 orbit with |μ| = 1.003, which the chain leaves in the long run.
    found = attractors(scene("sec2").evolve(f=1936.0), random_states=24)
    assert all(one.stable is not False for one in found)
    assert {one.regime.period for one in found} == {5, None}


@pytest.mark.parametrize(("chain", "comes"), [
    (scene("sec2").evolve(N=2, f=2000.0), True), (scene("sec2").evolve(N=3, D=0.0, f=2000.0), False)])
def test_an_irregular_motion_that_locks_to_an_orbit_is_noticed(chain: Scene, comes: bool) -> None:
    """One chain settles within a few periods, and one without damping has no attractor."""
    regime = Regime("quasi-periodic", None, None, None, 400, (1e-4, 1e-4), lyapunov_periods=400)
    result = SteadyState(chain, np.ones(3), regime, None, rest(chain))
    assert _locks(Candidate(result, np.zeros((1, 2, chain.N))), None) is comes


@pytest.mark.parametrize(("mean", "error", "name"), [
    (0.0, 1e-4, "quasi-periodic"), (3e-3, 2e-3, "quasi-periodic"), (2e-2, 1e-3, "unsettled"), (4e-2, 1e-3, "chaotic")])
def test_a_group_with_several_names_is_judged_by_the_rule_for_one(mean: float, error: float, name: str) -> None:
    """The standard error of their mean is smaller than that of each, but the bias of a finite record is the same in
    all.
    """
    group = [Regime(one, None, None, None, 800, (mean, error)) for one in ("quasi-periodic", "chaotic", "unsettled") * 3]
    assert irregular_regime(group).name == name


@pytest.mark.parametrize("name", ["quasi-periodic", "chaotic", "unsettled"])
def test_a_group_with_one_name_keeps_it(name: str) -> None:
    found = irregular_regime([Regime(name, None, None, None, 800, (one, 3e-4)) for one in (0.01, 0.02, 0.03)])
    assert found.name == name and found.lyapunov == (pytest.approx(0.02), pytest.approx(1e-4 * 3.0**0.5))


def test_shares_without_a_single_hit_still_have_an_error() -> None:
    assert share(0, 64) == (0.0, pytest.approx(0.0206, abs=1e-3)) and share(0, 0) == (None, None)
    assert share(32, 64) == (0.5, pytest.approx(0.0606, abs=1e-3))


@pytest.mark.parametrize(("count", "of", "low", "high"), [
    (6, 6, 0.6097, 1.0), (0, 6, 0.0, 0.3903), (37, 64, 0.4561, 0.6914), (0, 64, 0.0, 0.0566)])
def test_the_interval_of_a_share_is_wilsons(count: int, of: int, low: float, high: float) -> None:
    """It agrees with SciPy's `binomtest(count, of).proportion_ci(method="wilson")`, and the first case with 6 / (6 +
    1.96²).
    """
    assert share_interval(count, of) == pytest.approx((low, high), abs=1e-4)
    expected = binomtest(count, of).proportion_ci(method="wilson")
    assert share_interval(count, of) == pytest.approx((expected.low, expected.high), rel=1e-12, abs=1e-15)
    assert share_interval(0, 0) is None


def test_a_share_is_shown_with_its_interval() -> None:
    """A share with ± one standard error used to exceed 100 %."""
    found = attractors(scene("sec2").evolve(N=2, f=2000.0), random_states=6)
    assert [one.share_words for one in found] == ["100 % (61 to 100 %)"]
    assert found.to_xarray()["share_low"].values == pytest.approx(0.6097, abs=1e-4)


def test_without_random_states_no_share_is_stated() -> None:
    found = attractors(scene("sec2").evolve(N=2, f=2000.0), random_states=0)
    assert [(one.share, one.share_error, one.share_words) for one in found] == [(None, None, "–")]
    assert not any("%" in line for line in listing(found))
    assert np.isnan(found.to_xarray()["share"]).all() and np.isnan(found.to_xarray()["share_error"]).all()


def test_failed_starts_are_named_and_count_among_the_random_states(monkeypatch: pytest.MonkeyPatch) -> None:
    """One of two random states presses bead 2 a metre into the wall, and its numbers overflow immediately."""
    chain = scene("sec2").evolve(N=2, f=2000.0)
    pressed = State(np.array([0.0, 1.0]), np.zeros(2))
    origins = [Origin("rest", rest(chain)), Origin("random 0", rest(chain)), Origin("random 1", pressed)]
    # the package has a function with the name of the module
    monkeypatch.setattr(sys.modules["granchain_core.attractor_search.attractors"], "_origins", lambda *_: origins)
    found = attractors(chain, random_states=2)
    assert [one.share for one in found] == [0.5]
    assert [origin.name for origin in found.failed] == ["random 1"]
    assert found.summary()[-1] == "1 start failed: random 1"


def test_the_error_has_the_status_of_the_failure_that_occurred(monkeypatch: pytest.MonkeyPatch) -> None:
    """All starts fail, for a reason other than an overflow."""
    module = sys.modules["granchain_core.attractor_search.attractors"]
    chain = scene("sec2").evolve(N=2, f=2000.0)
    failed = SteadyState(chain, np.full(3, np.nan), Regime("unsettled", None, None, None, 0, None), None, rest(chain),
                         "One drive period needs millions of steps.", "too-many-steps")
    monkeypatch.setattr(module, "settle_on_all_cores", lambda *_: [failed])
    with pytest.raises(ComputationError, match="millions of steps") as caught:
        module.attractors_from(chain, [Origin("rest", rest(chain))])
    assert caught.value.status == "too-many-steps"


def test_too_many_states_are_refused() -> None:
    with pytest.raises(BadInput, match="nearest valid value is 10000"):
        attractors(scene("sec2"), random_states=10**9)


def test_the_listing_has_share_and_regime(many: list[Attractor]) -> None:
    lines = list(listing(many))
    assert len(lines) == len(many) and lines[0].startswith("period 3") and "%) of random states" in lines[0]
