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
class _Cache:
    """What has been found out about properties, by class and name of the property."""

    #: Defaults that are constants, which all models of a class share.
    constants: dict[tuple[type, str], Any] = field(default_factory=dict)
    #: Whether each model has its own default ("unstable" in Bokeh).
    unstable: dict[tuple[type, str], bool] = field(default_factory=dict)
    #: Whether such an own default is an empty list or dictionary.
    empty: dict[tuple[type, str], bool] = field(default_factory=dict)
    #: The defaults that a class and its bases override, by class alone.
    overridden: dict[type, dict[str, Any]] = field(default_factory=dict)


def install_defaults_cache() -> None:
    """Replace the functions that Bokeh uses to find the defaults of its models."""
    if missing(INTERNALS) or hasattr(PropertyDescriptor._get_default, "known"):
        return
    find: Any = PropertyDescriptor._get_default
    overridden: Any = HasProps._overridden_defaults
    query, visit = HasProps.query_properties_with_values, references.visit_immediate_value_references
    cache = _Cache()
    is_unstable = _cached_is_unstable(PropertyDescriptor.has_unstable_default, cache)
    for where, name, ours in (
            (PropertyDescriptor, "has_unstable_default", is_unstable),
            (PropertyDescriptor, "_get_default", _cached_default(find, is_unstable, cache)),
            (HasProps, "themed_values", _theme),
            (HasProps, "_overridden_defaults", classmethod(_cached_overrides(overridden, cache))),
            (HasProps, "query_properties_with_values", _properties_that_differ(query)),
            (references, "visit_immediate_value_references", _visit_existing_references(visit, cache))):
        setattr(where, name, ours)


def _theme(model: Any) -> dict[str, Any] | None:
    """Return a model's themed values without a search of its classes, as the attribute is hardly ever set."""
    themed: dict[str, Any] | None = model.__dict__.get("__themed_values__")
    return themed


def _cached_overrides(overridden: Any, cache: _Cache) -> Callable[[type], dict[str, Any]]:
    """Return a function that finds the defaults overridden by a class and its bases only once, as they never change."""

    def overrides(cls: type) -> dict[str, Any]:
        if cls not in cache.overridden:
            cache.overridden[cls] = overridden.__func__(cls)
        return cache.overridden[cls]

    return overrides


def _cached_is_unstable(unstable: Any, cache: _Cache) -> Callable[[Any, Any], bool]:
    """Return a function that says whether each model has its own default.

    For a new model, the answer is no if its default would be empty: the default is made when it is requested, and is
    not sent to the browser anyway.
    """

    def is_unstable(descriptor: Any, model: Any) -> bool:
        key = (model.__class__, descriptor.name)
        if key not in cache.unstable:
            cache.unstable[key] = unstable(descriptor, model)
            value = descriptor.instance_default(model) if cache.unstable[key] else None
            cache.empty[key] = isinstance(value, PropertyValueContainer) and not value
        return cache.unstable[key] and not (cache.empty[key] and not model._initialized)

    return is_unstable


def _cached_default(find: Any, is_unstable: Callable[[Any, Any], bool], cache: _Cache) -> Callable[[Any, Any], Any]:
    """Return a function that finds a property's default, once per class if it is a constant that no theme changes."""

    def default(descriptor: Any, model: Any) -> Any:
        themed = _theme(model)
        if themed and descriptor.name in themed:
            return find(descriptor, model)
        key = (model.__class__, descriptor.name)
        if key in cache.constants:
            return cache.constants[key]
        value = find(descriptor, model)
        if isinstance(value, _CONSTANTS) and not is_unstable(descriptor, model):
            cache.constants[key] = value
        return value

    default.known = cache.constants  # type: ignore[attr-defined]
    return default


def _properties_that_differ(query: Any) -> Callable[..., dict[str, Any]]:
    """Return a function that finds a model's properties for the browser without looking at all its defaults."""

    def differing(model: Any, wanted: Callable[[Any], bool], *, include_defaults: bool = True,
                include_undefined: bool = False) -> dict[str, Any]:
        if include_defaults or include_undefined:
            return dict(query(model, wanted, include_defaults=include_defaults, include_undefined=include_undefined))
        themed, own = _theme(model) or {}, model._unstable_default_values
        names = {*model._property_values, *own, *themed}
        values = {}
        for name in model.properties(_with_props=True):
            descriptor = model.lookup(name) if name in names else None
            if descriptor is not None and wanted(descriptor):
                value = descriptor.get_value(model)
                if name in themed or not (name in own and isinstance(value, PropertyValueContainer)):
                    values[name] = value
        return values

    return differing


def _visit_existing_references(visit: Any, cache: _Cache) -> Callable[[Any, Any], None]:
    """Return a function that visits the models to which a model refers, without making empty defaults for this."""

    def visit_model(value: Any, visitor: Any) -> None:
        if not isinstance(value, HasProps):
            visit(value, visitor)
            return
        kind, themed = value.__class__, _theme(value) or {}
        kept_values = value._property_values, value._unstable_default_values, themed
        for name in value.properties_with_refs():
            key = (kind, name)
            if (key in cache.constants or cache.empty.get(key)) and not any(name in kept for kept in kept_values):
                continue
            references.visit_value_and_its_immediate_references(getattr(value, name), visitor)

    return visit_model
