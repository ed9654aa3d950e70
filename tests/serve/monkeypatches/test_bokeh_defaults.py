"""Remembered defaults of Bokeh's properties: a page receives the same content as without them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

import pytest
from bokeh.core.property.descriptors import PropertyDescriptor
from bokeh.document import Document
from bokeh.models import CustomJS, InlineStyleSheet, Select
from bokeh.plotting import figure
from bokeh.themes import Theme
from missing_attribute import lose
from replaced import OWN, REPLACED

from app.serve.monkeypatches.bokeh_defaults import INTERNALS, install_defaults_cache

CHANGES = Theme(json={"attrs": {"Axis": {"axis_label_text_font_size": "31px"}, "Line": {"line_width": 7}}})


@pytest.fixture(autouse=True)
def restored(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Restore Bokeh's own functions for a test, and the replacements after it."""
    for where, name, own in OWN:
        monkeypatch.setattr(where, name, own)
    yield


def described(theme: Theme | None) -> str:
    """Return a figure and a widget as sent to a browser, with models numbered in order of appearance."""
    document = Document(theme=theme) if theme else Document()
    plot = figure(x_axis_label="time (s)")
    plot.line([0, 1], [0, 1], legend_label="force")
    document.add_root(plot)
    document.add_root(Select(options=["rest", "up"], value="up"))
    plot.yaxis.axis_label = "force (N)"
    numbers: dict[str, int] = {}
    content = json.dumps(document.to_json(deferred=False)["roots"], default=str)
    return re.sub(r"\bp\d+\b", lambda found: f"p{numbers.setdefault(found[0], len(numbers))}", content)


def test_remembered_defaults_describe_the_same_document() -> None:
    before = described(None), described(CHANGES)
    assert before[0] != before[1] and "31px" in before[1]
    install_defaults_cache()
    assert (described(None), described(CHANGES)) == before
    assert PropertyDescriptor._get_default.known  # it is in use
    assert (described(CHANGES), described(None)) == before[::-1]  # remembered values belong to no theme


def test_models_do_not_share_mutable_defaults() -> None:
    install_defaults_cache()
    one, other = figure(), figure()
    one.line([0, 1], [0, 1])
    one.xaxis[0].major_label_overrides[1] = "one"
    assert one.renderers and not other.renderers
    assert not other.xaxis[0].major_label_overrides and one.x_range is not other.x_range


def test_an_empty_default_is_made_when_it_is_asked_for_and_is_the_models_own() -> None:
    install_defaults_cache()
    figure()
    one, other = figure(), figure()
    assert "tags" not in one._unstable_default_values
    one.tags.append("mine")
    assert one.tags == ["mine"] and other.tags == []
    assert "mine" in json.dumps(document_of(one).to_json(deferred=False)["roots"], default=str)


def document_of(model: object) -> Document:
    """Return a document with this root."""
    document = Document()
    document.add_root(model)
    return document


def test_a_document_contains_every_model_to_which_its_roots_refer() -> None:
    def kinds() -> list[str]:
        plot = figure()
        plot.line([0, 1], [0, 1], legend_label="force")
        plot.js_on_event("tap", CustomJS(code="1"))
        plot.stylesheets.append(InlineStyleSheet(css="a {}"))
        return sorted(type(model).__name__ for model in document_of(plot).models)

    before = kinds()
    assert {"CustomJS", "InlineStyleSheet", "Line"} < set(before)
    install_defaults_cache()
    assert kinds() == before == kinds()


def test_all_values_can_still_be_read() -> None:
    def all_values() -> list[str]:
        return sorted(Select(options=["rest"]).properties_with_values(include_defaults=True))

    before = all_values()
    install_defaults_cache()
    assert all_values() == before and "tags" in before


@pytest.mark.parametrize(("owner", "name"), [(row.owner, name) for row in INTERNALS for name in row.names],
                         ids=lambda value: value.rpartition(".")[2])
def test_a_release_without_a_part_of_it_keeps_its_own_ways(owner: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """This covers replaced functions and those that the replacements use, without which no page could be created."""
    lose(monkeypatch, owner, name)
    before = [getattr(one, other, None) for one, other in REPLACED]
    install_defaults_cache()
    assert [getattr(one, other, None) for one, other in REPLACED] == before
