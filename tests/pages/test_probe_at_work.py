"""Probe and Numbers, without a browser: they follow the settled picture, and cost nothing while hidden."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from page_host import PageUnderTest, picture

from granchain_core import BadInput, scene, settle


@pytest.fixture
def probe(page_of: Callable[[str], PageUnderTest]) -> PageUnderTest:
    """The Probe page."""
    return page_of("probe")


@pytest.fixture
def numbers(page_of: Callable[[str], PageUnderTest]) -> PageUnderTest:
    """The Numbers tab."""
    return page_of("numbers")


def test_the_probe_draws_every_picture_while_the_page_is_open(probe: PageUnderTest) -> None:
    probe.deliver_picture()
    assert probe.sent == []
    probe.set_visible()
    assert probe.state["sentence"].startswith("Bead 1 of 2") and len(probe.sent) == 1
    probe.deliver_picture(replace(picture(2100.0), final=False))
    assert len(probe.sent) == 2, "a preview, too"
    probe.set_visible(False)
    probe.deliver_picture()
    assert len(probe.sent) == 2


def test_the_probe_keeps_its_bead_and_a_shorter_chain_has_its_last_one(probe: PageUnderTest) -> None:
    probe.set_visible()
    probe.do("probe-bead", bead=2)
    assert (probe.state["bead"], probe.state["beads"]) == (2, 2)
    probe.deliver_picture(picture(2100.0))
    assert probe.state["bead"] == 2
    probe.deliver_picture(settle(scene("sec2").evolve(N=1, f=2000.0), samples=8))
    assert (probe.state["bead"], probe.state["beads"]) == (1, 1)
    with pytest.raises(BadInput, match="bead '3' is not a whole number"):
        probe.do("probe-bead", bead=3)


def test_every_final_picture_is_summarised_and_tables_wait_for_a_viewer(numbers: PageUnderTest) -> None:
    numbers.deliver_picture(replace(picture(), final=False))
    assert numbers.sent == []
    numbers.deliver_picture()
    assert numbers.last("numbers")["summary"].startswith("At 2000 Hz") and "beads" not in numbers.last("numbers")
    numbers.set_visible()
    assert len(numbers.last("numbers")["beads"]) == 2 and numbers.last("numbers")["forces"]
    numbers.set_visible(False)
    numbers.deliver_picture(picture(2100.0))
    assert numbers.last("numbers")["summary"].startswith("At 2100 Hz") and "beads" not in numbers.last("numbers")
