"""Monkeypatches of Bokeh: property defaults are found once for all models, and made only when needed.

Bokeh finds the defaults again for each model of a page, about 8000 times, and makes ten empty lists and dictionaries
for each model. This takes more than half of the time to make a page. The replaced functions are not public in Bokeh,
and neither are the parts that the replacements use. If a release lacks any of these, no function is replaced.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from bokeh.core.has_props import HasProps

try:
    import bokeh.model.util as references
    from bokeh.core.property.descriptors import PropertyDescriptor
    from bokeh.core.property.wrappers import PropertyValueContainer
except ImportError:  # then `missing` lists the missing names, and nothing is replaced
    pass

from ...library_internals import Internal, internals, missing

_WITHOUT = "opening a web page costs half as much again"
#: The undocumented parts of Bokeh that are used here.
INTERNALS = internals(
    __name__,
    Internal("bokeh.core.property.descriptors.PropertyDescriptor",
             ("_get_default", "has_unstable_default", "instance_default", "get_value"), _WITHOUT),
    Internal("bokeh.core.has_props.HasProps",
             ("_overridden_defaults", "query_properties_with_values", "themed_values", "__themed_values__",
              "_property_values", "_unstable_default_values", "_initialized", "properties_with_refs", "lookup"),
             _WITHOUT),
    Internal("bokeh.core.has_props.HasProps.properties", ("_with_props",), _WITHOUT),
    Internal("bokeh.model.util",
             ("visit_immediate_value_references", "visit_value_and_its_immediate_references"), _WITHOUT),
    Internal("bokeh.core.property.wrappers", ("PropertyValueContainer",), _WITHOUT),
)

#: Types of immutable values: models can share them.
_CONSTANTS = (type(None), bool, int, float, str, bytes)


@dataclass(frozen=True)
class _Remembered:
    """Constant defaults, whether a default is made for each model, and whether it is empty, by class and property."""

    known: dict[tuple[type, str], Any] = field(default_factory=dict)
    changing: dict[tuple[type, str], bool] = field(default_factory=dict)
    empty: dict[tuple[type, str], bool] = field(default_factory=dict)
    overridden: dict[type, dict[str, Any]] = field(default_factory=dict)


def install_defaults_cache() -> None:
    """Replace the functions that Bokeh uses to find the defaults of its models."""
    if missing(INTERNALS) or hasattr(PropertyDescriptor._get_default, "known"):
        return
    find: Any = PropertyDescriptor._get_default
    overridden: Any = HasProps._overridden_defaults
    query, visit = HasProps.query_properties_with_values, references.visit_immediate_value_references
    remembered = _Remembered()
    is_unstable = _asks_once(PropertyDescriptor.has_unstable_default, remembered)
    for where, name, ours in (
            (PropertyDescriptor, "has_unstable_default", is_unstable),
            (PropertyDescriptor, "_get_default", _finds_once(find, is_unstable, remembered)),
            (HasProps, "themed_values", _theme),
            (HasProps, "_overridden_defaults", classmethod(_merges_once(overridden, remembered))),
            (HasProps, "query_properties_with_values", _tells_what_is_there(query)),
            (references, "visit_immediate_value_references", _visits_what_is_there(visit, remembered))):
        setattr(where, name, ours)


def _theme(model: Any) -> dict[str, Any] | None:
    """Return a model's themed values without a search of its classes, as the attribute is hardly ever set."""
    themed: dict[str, Any] | None = model.__dict__.get("__themed_values__")
    return themed


def _merges_once(overridden: Any, defaults: _Remembered) -> Callable[[type], dict[str, Any]]:
    """Return a function that finds the defaults overridden by a class and its bases only once, as they never change."""

    def overrides(cls: type) -> dict[str, Any]:
        if cls not in defaults.overridden:
            defaults.overridden[cls] = overridden.__func__(cls)
        return defaults.overridden[cls]

    return overrides


def _asks_once(unstable: Any, defaults: _Remembered) -> Callable[[Any, Any], bool]:
    """Return a function that says whether each model has its own default.

    For a new model, the answer is no if its default would be empty: the default is made when it is requested, and is
    not sent to the browser anyway.
    """

    def is_unstable(descriptor: Any, model: Any) -> bool:
        key = (model.__class__, descriptor.name)
        if key not in defaults.changing:
            defaults.changing[key] = unstable(descriptor, model)
            value = descriptor.instance_default(model) if defaults.changing[key] else None
            defaults.empty[key] = isinstance(value, PropertyValueContainer) and not value
        return defaults.changing[key] and not (defaults.empty[key] and not model._initialized)

    return is_unstable


def _finds_once(find: Any, is_unstable: Callable[[Any, Any], bool], defaults: _Remembered) -> Callable[[Any, Any], Any]:
    """Return a function that finds a property's default, once per class if it is a constant that no theme changes."""

    def remembered(descriptor: Any, model: Any) -> Any:
        themed = _theme(model)
        if themed and descriptor.name in themed:
            return find(descriptor, model)
        key = (model.__class__, descriptor.name)
        if key in defaults.known:
            return defaults.known[key]
        value = find(descriptor, model)
        if isinstance(value, _CONSTANTS) and not is_unstable(descriptor, model):
            defaults.known[key] = value
        return value

    remembered.known = defaults.known  # type: ignore[attr-defined]
    return remembered


def _tells_what_is_there(query: Any) -> Callable[..., dict[str, Any]]:
    """Return a function that finds a model's properties for the browser without looking at all its defaults."""

    def changed(model: Any, wanted: Callable[[Any], bool], *, include_defaults: bool = True,
                include_undefined: bool = False) -> dict[str, Any]:
        if include_defaults or include_undefined:
            return dict(query(model, wanted, include_defaults=include_defaults, include_undefined=include_undefined))
        themed, own = _theme(model) or {}, model._unstable_default_values
        names = {*model._property_values, *own, *themed}
        changed_values = {}
        for name in model.properties(_with_props=True):
            descriptor = model.lookup(name) if name in names else None
            if descriptor is not None and wanted(descriptor):
                value = descriptor.get_value(model)
                if name in themed or not (name in own and isinstance(value, PropertyValueContainer)):
                    changed_values[name] = value
        return changed_values

    return changed


def _visits_what_is_there(visit: Any, defaults: _Remembered) -> Callable[[Any, Any], None]:
    """Return a function that visits the models to which a model refers, without making empty defaults for this."""

    def visit_model(value: Any, visitor: Any) -> None:
        if not isinstance(value, HasProps):
            visit(value, visitor)
            return
        kind, themed = value.__class__, _theme(value) or {}
        kept_values = value._property_values, value._unstable_default_values, themed
        for name in value.properties_with_refs():
            key = (kind, name)
            if (key in defaults.known or defaults.empty.get(key)) and not any(name in kept for kept in kept_values):
                continue
            references.visit_value_and_its_immediate_references(getattr(value, name), visitor)

    return visit_model
