"""Pins and starts in a link are restored to the last bit, and damaged ones are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.dashboard.addresses import apply_address
from app.parts.time_figures.pinned_trains import DASHES, SIGNS
from app.session.initial_state import MOST_BEADS_IN_LINK, initial_state_text, read_initial_state
from app.session.pins import NAMES, Pin, compared_rows, read_pin, setting_words
from app.session.session import Session
from app.session.share import PINS
from granchain_core import BadInput, State, run, scene

SHOWN = scene("sec2").evolve(f=880.0)
RNG = np.random.default_rng(14)
START = State(1e-6 * RNG.standard_normal(11), 1e-2 * RNG.standard_normal(11))


def test_a_pinned_start_is_restored_to_the_last_bit() -> None:
    back = read_initial_state(initial_state_text(START), SHOWN)
    assert np.array_equal(back.displacement, START.displacement) and np.array_equal(back.velocity, START.velocity)
    assert back.phase == 0.0 and initial_state_text(None) == ""


def test_a_chain_that_is_too_long_begins_at_rest() -> None:
    assert initial_state_text(State(np.zeros(MOST_BEADS_IN_LINK), np.zeros(MOST_BEADS_IN_LINK))) != ""
    assert initial_state_text(State(np.zeros(MOST_BEADS_IN_LINK + 1), np.zeros(MOST_BEADS_IN_LINK + 1))) == ""


@pytest.mark.parametrize(("text", "told"), [
    ("!!", "damaged"), ("AAAA", "damaged"), ("", "damaged"), ("ä", "damaged"), (initial_state_text(State(np.zeros(3), np.zeros(3))), "has 3 beads"),
    (initial_state_text(replace(START, displacement=np.full(11, np.nan))), "impossible for a chain"),
    (initial_state_text(replace(START, velocity=np.full(11, 1e6))), "impossible for a chain"),
    (initial_state_text(replace(START, phase=1.0)), "impossible for a chain")])
def test_an_invalid_state_is_refused(text: str, told: str) -> None:
    with pytest.raises(BadInput, match=told):
        read_initial_state(text, SHOWN)


def test_pins_of_an_address_are_restored_completely() -> None:
    left = Session(SHOWN, start="previous", scale="fit", speed=0.25, energy_account=True, story="coexisting.2",
                   initial_state=START, pins=(Pin(scene("sec2")), Pin(scene("rig").evolve(D=12.0), START)))
    back = Session()
    start, refused = apply_address(back, left.link)
    assert refused == [] and start is not None
    back.initial_state = start
    assert back.link == left.link
    assert np.array_equal(back.pins[1].initial_state.velocity, START.velocity)  # type: ignore[union-attr]
    # omitted settings have their defaults again
    apply_address(back, "v=1")
    assert back.link == Session().link


def test_a_damaged_pin_is_left_out_and_reported() -> None:
    session = Session()
    _, refused = apply_address(session, "v=1&pin=scene%3Dsec2%26f%3Dlots&pin2=scene%3Drig&from=AAAA&story=none.1")
    assert [pin.scene.name for pin in session.pins] == ["rig"]
    assert len(refused) == 3 and "A pin in the link is damaged and was left out." in refused


def test_every_pin_has_a_name_a_field_and_dashes() -> None:
    assert len(NAMES) == len(PINS) == len(DASHES) == len(SIGNS)


def test_pinned_numbers_are_beside_the_present_ones() -> None:
    now, before = (run(scene("sec2").evolve(f=f), periods=2, record=1, samples=24) for f in (850.0, 340.0))
    rows = {row["title"]: row for row in compared_rows(now, [before, None])}
    output = rows["output force"]["pins"][0]  # type: ignore[index]
    assert output[1].startswith("−" if now.max_output_force < before.max_output_force else "+")
    assert output[2] == f"× {now.max_output_force / before.max_output_force:.3g}"
    assert rows["input force"]["pins"][1] == ["", "", ""]  # type: ignore[index]
    assert setting_words(before.scene, now.scene) == "f = 340 Hz"
    assert setting_words(now.scene, now.scene) == "the same knobs"
    assert read_pin(Pin(before.scene).text).scene == before.scene
