"""Remove attributes of a library that a later release might not have."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

import pytest


def hide(monkeypatch: pytest.MonkeyPatch, module: ModuleType, owner: type, name: str) -> list[str]:
    """Hide an attribute from `module` alone, because the library itself still needs it.

    The returned list gets the name whenever `module` looks for it and does not find it.
    """
    missed: list[str] = []

    def found(self: object, attribute: str) -> Any:
        if attribute == name and sys._getframe(1).f_globals.get("__name__") == module.__name__:
            missed.append(name)
            raise AttributeError(name)
        return object.__getattribute__(self, attribute)

    monkeypatch.setattr(owner, "__getattribute__", found)
    return missed


def lose(monkeypatch: pytest.MonkeyPatch, owner: str, name: str) -> None:
    """Remove a name in a table `INTERNALS` from its class or module, and from the attributes that instances set."""
    from app import library_internals

    found = library_internals._find(owner)
    for one in found.__mro__ if isinstance(found, type) else [found]:
        if name in vars(one):
            monkeypatch.delattr(one, name)
    attributes, keywords = library_internals._attributes, library_internals._keywords
    monkeypatch.setattr(library_internals, "_attributes", lambda one: attributes(one) - {name})
    monkeypatch.setattr(library_internals, "_keywords", lambda one: {*keywords(one)} - {name})
