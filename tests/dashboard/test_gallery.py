"""The gallery: every scene has a small picture computed from it, a sentence and a question of its own."""

from __future__ import annotations

import re
from urllib.parse import unquote

import numpy as np
import pytest

from app.dashboard.gallery import FOLDER, cards, first_sentence
from granchain_core import scene, scene_names
from tools.gallery import drawn

LARGEST = 15_000  # bytes of a picture


def test_every_scene_has_a_picture_and_there_are_no_others() -> None:
    names = set(scene_names())
    assert {path.stem for path in FOLDER.glob("*.svg")} == names
    assert max(path.stat().st_size for path in FOLDER.glob("*.svg")) <= LARGEST


def test_a_card_has_title_sentence_question_and_its_picture() -> None:
    found = cards()
    assert [card["name"] for card in found] == list(scene_names())
    assert len({card["ask"] for card in found}) == len(found)
    for card in found:
        assert card["title"] == scene(card["name"]).title and card["ask"].endswith("?")
        assert scene(card["name"]).look_at.startswith(card["sentence"].rstrip("."))
        kind, _, picture = card["picture"].partition(",")
        assert kind == "data:image/svg+xml"
        assert unquote(picture) == (FOLDER / f"{card['name']}.svg").read_text(encoding="utf-8")


def test_a_sentence_ends_at_a_full_stop_and_not_within_a_number() -> None:
    assert first_sentence("Bead 2 swings at 0.8 µm: far. Turn it round.") == "Bead 2 swings at 0.8 µm: far."
    assert first_sentence("Raise f.") == "Raise f."


@pytest.mark.parametrize("name", ["fig3a", "diode"])
def test_a_picture_is_that_of_its_scene(name: str) -> None:
    """Computed again, it has the same chain, and the same force at the wall to 1/100 of the line's width."""
    kept, now = (FOLDER / f"{name}.svg").read_text(encoding="utf-8"), drawn(scene(name))
    assert re.findall("<circle[^>]*>", kept) == re.findall("<circle[^>]*>", now)
    points = [np.array([[float(one) for one in point.split(",")] for point in re.findall('points="([^"]+)"', text)[0].split()])
              for text in (kept, now)]
    assert points[0] == pytest.approx(points[1], abs=0.4)
