"""What is left out while a page is made for a visitor changes nothing of what the visitor gets."""

from __future__ import annotations

import json
import re
from contextlib import nullcontext

import pytest
from bokeh.document import Document
from bokeh.models import Div, ImportedStyleSheet
from panel.io.state import set_curdoc
from panel.reactive import Reactive, Syncable

from app.dashboard import entry
from app.parts.status_line import StatusLine
from app.serve import websocket


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
    monkeypatch.setattr(websocket, "_COMMON", {})
    first = content()  # asks Panel for the properties of each part
    assert any(websocket._COMMON.values())
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


@pytest.mark.parametrize("properties", [
    {"data": None, "stylesheets": []}, {"stylesheets": []}, {"data": Div(), "stylesheets": [Div()]},
    {"data": Div(), "child": Div()},
])
def test_a_release_with_other_properties_is_asked_each_time(properties: dict[str, object],
                                                            monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(websocket, "_COMMON", {})
    asked = []

    class Panel:
        def _get_properties(self, document: Document) -> dict[str, object]:
            asked.append(document)
            return properties

    part = type("Part", (websocket.WithCommonProperties, Panel), {"param": ()})()
    document = Document()
    assert part._get_properties(document) is part._get_properties(document) is properties
    assert asked == [document, document]


@pytest.mark.parametrize("release", ["this one", "another"])
def test_a_change_reaches_the_model_without_the_design(release: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """State and style sheets both; with a release that makes the changes elsewhere Panel's own way is taken."""
    part, document = StatusLine(None), Document()
    model = part.get_root(document)
    asked: list[object] = []
    monkeypatch.setattr(part._design, "params", lambda *_: asked.append(1) or ({}, {}))
    if release == "another":
        monkeypatch.delattr(Syncable, "_update_properties")
        monkeypatch.setattr(Reactive, "_update_properties", lambda self, *events, doc: {one.name: one.new for one in events})
    part.update_state(force="1 N at the wall")
    assert model.data.state["force"] == "1 N at the wall" and not asked
    if release == "this one":
        part.stylesheets = [*part.stylesheets, ":host { color: red }"]
        assert asked and ":host { color: red }" in model.stylesheets
