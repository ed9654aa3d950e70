"""Defaults of Bokeh's properties, found once for all models and made when they are needed.

Bokeh finds a default anew for each of a page's models, some 8000 times, and makes ten empty lists and dictionaries for
each model: more than half of the making of a page. What is replaced here is not public in Bokeh; where a release lacks
a part of it, nothing is replaced.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bokeh.model.util as references
from bokeh.core.has_props import HasProps
from bokeh.core.property.descriptors import PropertyDescriptor
from bokeh.core.property.wrappers import PropertyValueContainer

#: Types of immutable values: models can share them.
_CONSTANTS = (type(None), bool, int, float, str, bytes)


def remember_defaults() -> None:
    """Replace Bokeh's ways to the defaults of its models."""
    find: Any = getattr(PropertyDescriptor, "_get_default", None)
    unstable: Any = getattr(PropertyDescriptor, "has_unstable_default", None)
    overridden: Any = getattr(HasProps, "_overridden_defaults", None)
    query: Any = getattr(HasProps, "query_properties_with_values", None)
    visit: Any = getattr(references, "visit_immediate_value_references", None)
    parts = find, unstable, overridden, query, visit, getattr(HasProps, "themed_values", None)
    if None in parts or hasattr(find, "known"):
        return
    known: dict[tuple[type, str], Any] = {}
    changing: dict[tuple[type, str], bool] = {}
    empty: dict[tuple[type, str], bool] = {}
    of_class: dict[type, dict[str, Any]] = {}

    def theme(model: Any) -> dict[str, Any] | None:
        """Without a search for an attribute that is hardly ever there."""
        return model.__dict__.get("__themed_values__")

    def overrides(cls: type) -> dict[str, Any]:
        """Those of a class and its bases; nobody changes them."""
        if cls not in of_class:
            of_class[cls] = overridden.__func__(cls)
        return of_class[cls]

    def is_unstable(descriptor: Any, model: Any) -> bool:
        """Whether each model has a default of its own. A new model is told that it has none where it would be empty:
        it is made when it is asked for, and a browser is not told of it anyway."""
        key = (model.__class__, descriptor.name)
        if key not in changing:
            changing[key] = unstable(descriptor, model)
            value = descriptor.instance_default(model) if changing[key] else None
            empty[key] = isinstance(value, PropertyValueContainer) and not value
        return changing[key] and not (empty[key] and not model._initialized)

    def remembered(descriptor: Any, model: Any) -> Any:
        """A constant that no theme changes."""
        themed = theme(model)
        if themed and descriptor.name in themed:
            return find(descriptor, model)
        key = (model.__class__, descriptor.name)
        if key in known:
            return known[key]
        value = find(descriptor, model)
        if isinstance(value, _CONSTANTS) and not is_unstable(descriptor, model):
            known[key] = value
        return value

    def changed(model: Any, wanted: Callable[[Any], bool], *, include_defaults: bool = True,
                include_undefined: bool = False) -> dict[str, Any]:
        """What a browser is told of a model, without a look at all its defaults."""
        if include_defaults or include_undefined:
            return dict(query(model, wanted, include_defaults=include_defaults, include_undefined=include_undefined))
        themed, own = theme(model) or {}, model._unstable_default_values
        names = {*model._property_values, *own, *themed}
        found = {}
        for name in model.properties(_with_props=True):
            descriptor = model.lookup(name) if name in names else None
            if descriptor is not None and wanted(descriptor):
                value = descriptor.get_value(model)
                if name in themed or not (name in own and isinstance(value, PropertyValueContainer)):
                    found[name] = value
        return found

    def visit_what_is_there(value: Any, visitor: Any) -> None:
        """The models to which a model refers, without making what would be empty."""
        if not isinstance(value, HasProps):
            visit(value, visitor)
            return
        kind, themed = value.__class__, theme(value) or {}
        there = value._property_values, value._unstable_default_values, themed
        for name in value.properties_with_refs():
            key = (kind, name)
            if (key in known or empty.get(key)) and not any(name in one for one in there):
                continue
            references.visit_value_and_its_immediate_references(getattr(value, name), visitor)

    remembered.known = known  # type: ignore[attr-defined]
    for where, name, ours in (
            (PropertyDescriptor, "has_unstable_default", is_unstable), (PropertyDescriptor, "_get_default", remembered),
            (HasProps, "themed_values", theme), (HasProps, "_overridden_defaults", classmethod(overrides)),
            (HasProps, "query_properties_with_values", changed),
            (references, "visit_immediate_value_references", visit_what_is_there)):
        setattr(where, name, ours)
