"""Words in results and files: how a motion started, and its regime in one sentence."""

from __future__ import annotations

from dataclasses import replace

from granchain_core import State, scene
from granchain_core.results.regime import Regime
from granchain_core.results.run import start_words
from granchain_core.scene.state import rest


def test_a_run_says_where_it_began() -> None:
    chain = scene("sec2")
    assert start_words(chain, None) == "rest"
    assert start_words(replace(chain, start_velocity=((1, 0.01),)), None) == "initial velocity"
    given: State = rest(chain)
    assert start_words(chain, given) == "given state"


def test_the_sentence_claims_no_more_than_the_periods_show() -> None:
    """`run` computes a given number of periods, so a motion settled within them, not after them."""
    settled = Regime("periodic", 3, 0.54, 1e-8, 303)
    assert settled.sentence == "period 3, settled within 303 periods (transient shrinks to 0.54 every 3 periods)"
    followed = replace(settled, orbit_found_by="Newton", multiplier=0.995, periods_run=400)
    assert followed.sentence == "period 3, orbit found after 400 periods of approach (|μ| 0.9950 per 3 periods)"
    assumed = replace(followed, multiplier=None)  # from a batch, which computes no multiplier
    assert assumed.sentence == "period 3, orbit found after 400 periods of approach"
