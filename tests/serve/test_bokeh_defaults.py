"""Remembered defaults of Bokeh's properties: a page is told as it would be without them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

import pytest
from bokeh.core.property.descriptors import PropertyDescriptor
from bokeh.document import Document
from bokeh.models import Select
from bokeh.plotting import figure
from bokeh.themes import Theme

from app.serve.bokeh_defaults import remember_defaults

CHANGES = Theme(json={"attrs": {"Axis": {"axis_label_text_font_size": "31px"}, "Line": {"line_width": 7}}})


@pytest.fixture(autouse=True)
def restored(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Bokeh's own search is put back at the end."""
    monkeypatch.setattr(PropertyDescriptor, "_get_default", PropertyDescriptor._get_default)
    yield


def told(theme: Theme | None) -> str:
    """What a browser is told of a figure and a widget, with models numbered as they come."""
    document = Document(theme=theme) if theme else Document()
    plot = figure(x_axis_label="time (s)")
    plot.line([0, 1], [0, 1], legend_label="force")
    document.add_root(plot)
    document.add_root(Select(options=["rest", "up"], value="up"))
    plot.yaxis.axis_label = "force (N)"
    numbers: dict[str, int] = {}
    content = json.dumps(document.to_json(deferred=False)["roots"], default=str)
    return re.sub(r"\bp\d+\b", lambda found: f"p{numbers.setdefault(found[0], len(numbers))}", content)


def test_a_document_is_told_the_same() -> None:
    before = told(None), told(CHANGES)
    assert before[0] != before[1] and "31px" in before[1]
    remember_defaults()
    assert (told(None), told(CHANGES)) == before
    assert PropertyDescriptor._get_default.known  # it is in use
    assert (told(CHANGES), told(None)) == before[::-1]  # what is remembered now belongs to no theme


def test_models_do_not_share_what_one_of_them_may_change() -> None:
    remember_defaults()
    one, other = figure(), figure()
    one.line([0, 1], [0, 1])
    one.xaxis[0].major_label_overrides[1] = "one"
    assert one.renderers and not other.renderers
    assert not other.xaxis[0].major_label_overrides and one.x_range is not other.x_range


@pytest.mark.parametrize("name", ["_get_default", "has_unstable_default"])
def test_a_release_without_that_search_keeps_its_own(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    class Newer:
        _get_default = has_unstable_default = None

    delattr(Newer, name)
    monkeypatch.setattr("app.serve.bokeh_defaults.PropertyDescriptor", Newer)
    before = dict(vars(Newer))
    remember_defaults()
    assert dict(vars(Newer)) == before
