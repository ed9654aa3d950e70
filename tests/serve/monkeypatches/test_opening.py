"""Shortcuts taken while a visitor's page is created do not change the page."""

from __future__ import annotations

import json
import re
from contextlib import nullcontext

import pytest
from bokeh.core.property.descriptors import PropertyDescriptor
from bokeh.document import Document
from bokeh.models import ImportedStyleSheet
from panel.io.state import set_curdoc
from replaced import OWN

from app.dashboard import entry
from app.parts.status.status_line import StatusLine
from app.parts.toolkit import panel_overrides
from app.serve.monkeypatches.bokeh_defaults import install_defaults_cache


def content() -> str:
    """Return the JSON of a new page, with its ids renumbered in order."""
    document = Document()
    with set_curdoc(document):
        entry.open_web_page()
    numbers: dict[str, int] = {}
    text = json.dumps(document.to_json(deferred=False)["roots"], default=str)
    text = re.sub(r"\bp\d+\b", lambda found: f"p{numbers.setdefault(found[0], len(numbers))}", text)
    return re.sub(r"([A-Z][A-Za-z]+)\d{5}", r"\1", text)


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> str:
    """The content of a page without shortcuts; those of other tests are removed, and restored afterwards."""
    for where, name, own in OWN:
        monkeypatch.setattr(where, name, own)
    assert not hasattr(PropertyDescriptor._get_default, "known")
    monkeypatch.setattr(panel_overrides, "_COMMON", {})
    monkeypatch.setattr(panel_overrides, "_CHILDLESS", set())
    with monkeypatch.context() as checked:
        checked.setattr(entry, "validate", lambda _: nullcontext())
        return content()  # asks Panel for the properties and children of each part


def test_a_page_with_every_shortcut_is_the_same(plain: str) -> None:
    """The shortcuts of `install_resources_cache` are outside of the document; test_panel_resources.py tests them."""
    assert len(json.loads(plain)) > 15
    assert any(panel_overrides._COMMON.values()) and panel_overrides._CHILDLESS
    assert content() == plain  # with remembered properties, and without checks of values
    install_defaults_cache()
    assert content() == plain == content()
    assert PropertyDescriptor._get_default.known  # it is in use


def test_each_document_imports_its_own_style_sheets() -> None:
    StatusLine(None).get_root(Document())  # the first one asks Panel
    parts = [StatusLine(None) for _ in range(3)]
    one, other = Document(), Document()
    sheets = [[sheet for sheet in part.get_root(document).stylesheets if isinstance(sheet, ImportedStyleSheet)]
              for part, document in zip(parts, (one, one, other), strict=True)]
    assert sheets[0] and sheets[0] == sheets[1]
    assert [sheet.url for sheet in sheets[2]] == [sheet.url for sheet in sheets[0]]
    assert not set(sheets[2]) & set(sheets[0])
