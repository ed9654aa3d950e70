"""The steps of Panel that parts skip change nothing, and Panel's own code is used if its methods have changed."""

from __future__ import annotations

import importlib.util
import sys

import pytest
from bokeh.document import Document
from bokeh.events import Event
from bokeh.models import Div
from missing_attribute import hide
from panel.custom import JSComponent
from panel.reactive import Reactive, Syncable

from app import library_internals
from app.parts.status.status_line import StatusLine
from app.parts.toolkit import panel_overrides
from app.parts.toolkit.component import Component

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("properties", [
    {"data": None, "stylesheets": []}, {"stylesheets": []}, {"data": Div(), "stylesheets": [Div()]},
    {"data": Div(), "child": Div()},
])
def test_a_release_with_other_properties_is_asked_each_time(properties: dict[str, object],
                                                            monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(panel_overrides, "_COMMON", {})
    asked = []

    class Panel:
        def _get_properties(self, document: Document) -> dict[str, object]:
            asked.append(document)
            return properties

    part = type("Part", (panel_overrides.WithCommonProperties, Panel), {"param": ()})()
    document = Document()
    assert part._get_properties(document) is part._get_properties(document) is properties
    assert asked == [document, document]


@pytest.mark.parametrize("release", ["this one", "another"])
def test_a_change_reaches_the_model_without_the_design(release: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """This is true of state and style sheets. With a release that makes changes elsewhere, Panel's own code is used."""
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


class Part(Component):
    """A part of the page that does nothing."""

    _esm = "export function render() {}"


def test_an_event_of_a_part_is_handled_with_and_without_panels_private_method(monkeypatch: pytest.MonkeyPatch) -> None:
    handled: list[tuple[str, Event]] = []
    document, event = Document(), Event()
    monkeypatch.setattr(JSComponent, "_process_event", lambda _, one: handled.append(("directly", one)))
    Part()._process_bokeh_event(document, event)
    monkeypatch.setattr(JSComponent, "_process_bokeh_event", lambda _, __, one: handled.append(("by Panel", one)))
    hide(monkeypatch, panel_overrides, Part, "_process_event")
    Part()._process_bokeh_event(document, event)
    assert handled == [("directly", event), ("by Panel", event)]


def test_an_event_of_a_part_is_handled_by_panel_where_that_has_no_set_curdoc(monkeypatch: pytest.MonkeyPatch) -> None:
    """The module can be imported without it, and leaves the event to Panel."""
    monkeypatch.delattr(sys.modules["panel.io.state"], "set_curdoc")
    monkeypatch.setattr(library_internals, "_TABLES", dict(library_internals._TABLES))  # the copy enters its own table
    spec = importlib.util.spec_from_file_location("app.parts.toolkit.without_set_curdoc", panel_overrides.__file__)
    assert spec is not None and spec.loader is not None
    without = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(without)
    assert without.set_curdoc is None
    handled: list[Event] = []

    class Panel:
        """The class that handles events in a release in which Panel does so alone."""

        def _process_bokeh_event(self, document: Document, event: Event) -> None:
            handled.append(event)

        def _process_event(self, event: Event) -> None:
            pytest.fail("it needs set_curdoc")

    event = Event()
    type("Part", (without.WithoutBusyIndicator, Panel), {})()._process_bokeh_event(Document(), event)
    assert handled == [event]
