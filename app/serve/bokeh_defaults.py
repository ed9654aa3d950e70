"""Defaults of Bokeh's properties, found once for all models."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bokeh.core.property.descriptors import PropertyDescriptor

#: Types of immutable values: models can share them.
_CONSTANTS = (type(None), bool, int, float, str, bytes)


def remember_defaults() -> None:
    """Ask Bokeh once for a property's default instead of once for every model: a fifth of an opening's work.

    Bokeh merges the overridden defaults of all base classes each time, some 8000 times a page. Only constants are
    remembered, of properties that no theme changes and that make no new default for every model. Where a release finds
    defaults in another way, they are found so.
    """
    find: Callable[[Any, Any], Any] | None = getattr(PropertyDescriptor, "_get_default", None)
    unstable: Callable[[Any, Any], bool] | None = getattr(PropertyDescriptor, "has_unstable_default", None)
    if find is None or unstable is None or hasattr(find, "known"):
        return
    known: dict[tuple[type, str], Any] = {}
    changing: dict[tuple[type, str], bool] = {}

    def is_unstable(descriptor: Any, model: Any) -> bool:
        key = (model.__class__, descriptor.name)
        if key not in changing:
            changing[key] = unstable(descriptor, model)
        return changing[key]

    def remembered(descriptor: Any, model: Any) -> Any:
        themed = model.themed_values()
        if themed and descriptor.name in themed:
            return find(descriptor, model)
        key = (model.__class__, descriptor.name)
        if key in known:
            return known[key]
        value = find(descriptor, model)
        if isinstance(value, _CONSTANTS) and not is_unstable(descriptor, model):
            known[key] = value
        return value

    remembered.known = known  # type: ignore[attr-defined]
    PropertyDescriptor.has_unstable_default = is_unstable
    PropertyDescriptor._get_default = remembered
