"""The gallery of scenes: a card for each with a small picture, its title, a sentence and a question.

The pictures are computed beforehand (`python -m tools.gallery`), and a page gets all cards in one message when its
visitor opens the gallery: nothing of it is part of the page's opening.
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
    """Name, title, sentence, question and picture of every scene; the picture is an address that holds it."""
    return [{"name": name, "title": scene(name).title, "sentence": first_sentence(scene(name).look_at),
             "ask": question_of(name), "picture": thumbnail_of(name)} for name in scene_names()]


def first_sentence(text: str) -> str:
    """The text up to the first full stop that ends a word."""
    return text.partition(". ")[0].rstrip(".") + "."


def thumbnail_of(name: str) -> str:
    """The picture of a scene as an address that holds it."""
    return "data:image/svg+xml," + quote((FOLDER / f"{name}.svg").read_text(encoding="utf-8"), safe=" =:/;,'()+")
