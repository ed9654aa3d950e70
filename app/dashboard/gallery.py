"""The gallery of scenes: for each scene a card with a small picture, a title, a sentence and a question.

The pictures are computed beforehand (`python -m tools.gallery`). A page gets all cards in one message when its visitor
opens the gallery, so that the gallery does not slow down opening the page.
"""

from __future__ import annotations

from functools import cache
from urllib.parse import quote

from granchain_core import scene, scene_names
from granchain_core.scene import ASSETS
from granchain_core.scene.presets import question_of

FOLDER = ASSETS / "gallery"


@cache
def cards() -> list[dict[str, str]]:
    """Return name, title, sentence, question and picture (a data URL) of every scene."""
    return [{"name": name, "title": scene(name).title, "sentence": first_sentence(scene(name).look_at),
             "ask": question_of(name), "picture": thumbnail_of(name)} for name in scene_names()]


def first_sentence(text: str) -> str:
    """Return the text up to the first full stop that ends a word."""
    return text.partition(". ")[0].rstrip(".") + "."


def thumbnail_of(name: str) -> str:
    """Return the picture of a scene as a data URL."""
    return "data:image/svg+xml," + quote((FOLDER / f"{name}.svg").read_text(encoding="utf-8"), safe=" =:/;,'()+")
