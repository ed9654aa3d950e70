"""Overrides of Panel's private methods that skip work our parts do not need; each is a mixin of `Component`.

The overrides concern properties, children, design, busy indicator and changes. If a release has other methods, Panel's
own methods are used.
"""

from __future__ import annotations

import weakref
from typing import Any, NamedTuple

from bokeh.document import Document
from bokeh.events import Event
from bokeh.model import Model, collect_models
from bokeh.models import ImportedStyleSheet
from panel.reactive import Syncable

from ...library_internals import Internal, internals
from ...serve.document.changes import is_batched, send_event, set_properties

try:
    from panel.io.state import set_curdoc
except ImportError:  # not in Panel's documentation
    set_curdoc = None  # type: ignore[assignment]

try:
    from panel.models.esm import ESMEvent
except ImportError:  # not documented either
    ESMEvent = None  # type: ignore[assignment,misc]

_WITHOUT = "Panel's own methods are used, which are some milliseconds slower"
#: The undocumented parts of Panel and Param that are used here.
INTERNALS = internals(
    __name__,
    Internal("panel.custom.JSComponent",
             ("_get_properties", "_get_children", "_update_properties", "_process_event", "_process_bokeh_event",
            "_models"), _WITHOUT),
    Internal("param.parameterized.Parameterized", ("_param__private",), _WITHOUT),
    Internal("panel.io.state", ("set_curdoc",), _WITHOUT),
    Internal("panel.models.esm", ("ESMEvent",), _WITHOUT),
)


class _Common(NamedTuple):
    """The properties shared by the models of all instances of a part, and the names of the other properties.

    A style sheet is given as its text, or as the address of a sheet that each document imports once.
    """

    properties: dict[str, Any]
    sheets: tuple[tuple[bool, str], ...]
    data: type[Model]
    own: frozenset[str]

    @classmethod
    def of(cls, part: Any, properties: dict[str, Any]) -> _Common | None:
        """Make this from the properties of a class's first instance; None if they are not as expected."""
        properties = {**properties, "_defs": []}  # the data class is defined only once
        data, sheets = properties.pop("data", None), properties.pop("stylesheets", [])
        if not isinstance(data, Model) or collect_models(properties):
            return None
        if not all(isinstance(sheet, (str, ImportedStyleSheet)) for sheet in sheets):
            return None
        own = frozenset(name for name in data.properties() - Model.properties() if name in part.param)
        return cls(properties, tuple((isinstance(sheet, str), str(getattr(sheet, "url", sheet))) for sheet in sheets),
                   type(data), own | {"name"})

    def properties_of(self, part: Any, imported: dict[str, ImportedStyleSheet]) -> dict[str, Any]:
        """Return the properties of another instance; `imported` has the sheets that its document imports, by URL."""
        sheets = [text if is_text else imported.get(text) or imported.setdefault(text, ImportedStyleSheet(url=text))
                  for is_text, text in self.sheets]
        return {**self.properties, "stylesheets": sheets,
                "data": self.data(**{name: getattr(part, name) for name in self.own})}


_COMMON: dict[type, _Common | None] = {}
_IMPORTED: weakref.WeakKeyDictionary[Document, dict[str, ImportedStyleSheet]] = weakref.WeakKeyDictionary()


class WithCommonProperties:
    """A Panel component that finds the properties of its model once per class.

    Instances differ only in their data. Panel goes through 40 parameters of each part for every session, which is a
    tenth of the work of opening a page. If a release has unexpected properties, Panel does so again.
    """

    def _get_properties(self, document: Document | None) -> dict[str, Any]:
        known = _COMMON.get(type(self))
        if known is not None and document is not None:
            return known.properties_of(self, _IMPORTED.setdefault(document, {}))
        properties: dict[str, Any] = super()._get_properties(document)  # type: ignore[misc]
        if type(self) not in _COMMON:
            _COMMON[type(self)] = _Common.of(self, properties)
        return properties


#: Classes of parts without children, as Panel found for their first instance.
_CHILDLESS: set[type] = set()


class WithoutChildren:
    """A Panel component that looks for children once per class.

    Panel looks at all 40 parameters of each instance. If a release calls another method, Panel does so again.
    """

    def _get_children(self, *args: Any) -> Any:
        if type(self) in _CHILDLESS:
            return {}, []
        children = super()._get_children(*args)  # type: ignore[misc]
        if children == ({}, []):
            _CHILDLESS.add(type(self))
        return children


class WithoutDesign:
    """A Panel component that consults its design only when style sheets change; the design affects nothing else.

    Panel works out the design's parameters at every change of every property, which takes half of the time of a change.
    If a release makes the changes elsewhere, Panel does so again.
    """

    def _update_properties(self, *events: Any, doc: Document) -> dict[str, Any]:
        plain = getattr(Syncable, "_update_properties", None)
        if plain is None or any(event.name == "stylesheets" for event in events):
            return super()._update_properties(*events, doc=doc)  # type: ignore[misc]
        changes: dict[str, Any] = plain(self, *events, doc=doc)
        return changes


class WithoutBusyIndicator:
    """A Panel component whose events skip the busy indicator, which takes 2 of 5 ms and is not shown on this page.

    Panel calls `_process_bokeh_event`. If a release calls another method or has no `set_curdoc`, the indicator is
    back.
    """

    def _process_bokeh_event(self, doc: Document, event: Event) -> None:
        handle = getattr(self, "_process_event", None)
        if handle is None or set_curdoc is None:
            super()._process_bokeh_event(doc, event)  # type: ignore[misc]
            return
        with set_curdoc(doc):
            handle(event)


class WithPlainChanges:
    """A Panel component, shown once, whose messages and plain values go straight to its model.

    Panel's own methods go through Param's watchers, Panel's queues and a search of the documents that show the
    component. `try_send` and `try_change` return False if Panel's methods must be used: before the page is connected,
    or with a release that keeps models or values elsewhere.
    """

    def _shown(self) -> Model | None:
        models = list(getattr(self, "_models", {}).values())
        return models[0][0] if len(models) == 1 else None

    def try_send(self, message: dict[str, Any]) -> bool:
        """Send a message to the part in the browser; return False if Panel has to send it."""
        model = self._shown()
        return model is not None and ESMEvent is not None and send_event(model, ESMEvent(model=model, data=message))

    def try_change(self, name: str, value: Any) -> bool:
        """Set a property of the part here and in the browser; return False if Panel has to set it."""
        data = getattr(self._shown(), "data", None)
        values = getattr(getattr(self, "_param__private", None), "values", None)
        if not isinstance(data, Model) or not isinstance(values, dict) or not is_batched(data):
            return False
        values[name] = value
        set_properties(data, **{name: value})
        return True
