"""What is left out while a page is made for a visitor changes nothing of what the visitor gets."""

from __future__ import annotations

import json
import re
from contextlib import nullcontext

import pytest
from bokeh.document import Document
from bokeh.models import ImportedStyleSheet
from panel.io.state import set_curdoc

from app.dashboard import entry
from app.parts.status.status_line import StatusLine
from app.serve.opening import panel_shortcuts


def content() -> str:
    """The JSON of a new page, with its numbered names in their order."""
    document = Document()
    with set_curdoc(document):
        entry.page()
    numbers: dict[str, int] = {}
    text = json.dumps(document.to_json(deferred=False)["roots"], default=str)
    text = re.sub(r"\bp\d+\b", lambda found: f"p{numbers.setdefault(found[0], len(numbers))}", text)
    return re.sub(r"([A-Z][A-Za-z]+)\d{5}", r"\1", text)


def test_a_page_without_checks_of_its_properties_and_with_remembered_ones_is_the_same(
        monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(panel_shortcuts, "_COMMON", {})
    first = content()  # asks Panel for the properties of each part
    assert any(panel_shortcuts._COMMON.values())
    assert content() == first
    monkeypatch.setattr(entry, "validate", lambda _: nullcontext())
    assert content() == first
    assert len(json.loads(first)) > 15


def test_each_document_imports_its_own_style_sheets() -> None:
    StatusLine(None).get_root(Document())  # the first one asks Panel
    parts = [StatusLine(None) for _ in range(3)]
    one, other = Document(), Document()
    sheets = [[sheet for sheet in part.get_root(document).stylesheets if isinstance(sheet, ImportedStyleSheet)]
              for part, document in zip(parts, (one, one, other), strict=True)]
    assert sheets[0] and sheets[0] == sheets[1]
    assert [sheet.url for sheet in sheets[2]] == [sheet.url for sheet in sheets[0]]
    assert not set(sheets[2]) & set(sheets[0])
