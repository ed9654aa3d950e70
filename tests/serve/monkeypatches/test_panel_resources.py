"""A page of the server has the scripts and style sheets that Panel would give it."""

from __future__ import annotations

import re

import panel.io.resources as resources
import panel.io.server as pages
import pytest
from listening import Listening

from app.serve.monkeypatches.panel_resources import install_resources_cache
from app.server import Access


@pytest.fixture
def own_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """Restore Panel's own functions, whatever server another test has started, and the replacements afterwards."""
    for name in ("bundle_resources", "patch_model_css"):
        monkeypatch.setattr(pages, name, getattr(resources, name))


def page_of(one: Listening) -> str:
    """Return the page as served, without the parts that differ between visitors."""
    status, _, text = one.ask()
    assert status == 200
    text = re.sub(r'"token":"[^"]+"', "", text)
    numbers: dict[str, int] = {}
    return re.sub(r"\bp\d+\b|[0-9a-f-]{36}", lambda found: f"p{numbers.setdefault(found[0], len(numbers))}", text)


@pytest.mark.usefixtures("own_way")
@pytest.mark.parametrize("name", ["bundle_resources", "patch_model_css", "patch_stylesheet"])
def test_a_release_without_a_part_of_it_keeps_its_own_way(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    where = resources if name == "patch_stylesheet" else pages
    before = pages.bundle_resources, pages.patch_model_css
    with monkeypatch.context() as lost:
        lost.delattr(where, name)
        install_resources_cache()
    assert (pages.bundle_resources, pages.patch_model_css) == before


@pytest.mark.usefixtures("own_way")
def test_remembered_resources_give_panels_page() -> None:
    one = Listening(Access())
    try:
        panels = page_of(one)
        install_resources_cache()
        assert pages.bundle_resources.known == {}
        assert [page_of(one) for _ in range(3)] == [panels] * 3
        assert len(pages.bundle_resources.known) == 1
    finally:
        one.stop()
