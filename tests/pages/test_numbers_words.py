"""The pictures in words: where the energy goes is stated only for a driven chain with damping."""

from __future__ import annotations

import pytest

from app.pages.numbers import words
from app.pages.numbers.words import summary
from granchain_core import scene, settle
from granchain_core.scene.effects import EFFECTS, Effect, effects_of

LOST = "On average, the damping of the contacts takes all the energy"


def test_the_loss_of_energy_is_described_for_driven_damped_chains_only() -> None:
    assert LOST in summary(settle(scene("sec2")).run)
    assert LOST not in summary(settle(scene("impact")).run)


def test_the_loss_of_energy_is_not_described_with_a_further_dissipating_effect(monkeypatch: pytest.MonkeyPatch) -> None:
    """An example is the drag of docs/add-an-effect.md. Foundation and preload store energy, and the force that is cut
    is the damped one.
    """
    run = settle(scene("sec2")).run
    drag = Effect("drag", "drag", "ground drag", "A viscous ground slows every bead.", lambda scene: True)
    storing = [effect for effect in EFFECTS if effect.name in ("tension", "foundation", "preload")]
    for others, said in ((storing, True), ([drag], False)):
        monkeypatch.setattr(words, "effects_of", lambda scene, others=others: [*effects_of(scene), *others])
        assert (LOST in summary(run)) == said
