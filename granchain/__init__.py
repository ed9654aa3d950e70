"""The public names of `granchain_core` under the project's name, with `figure` and `dashboard` added.

    import granchain
    result = granchain.run(granchain.scene("sec2").evolve(f=340.0))
    granchain.figure(result)                  # a Bokeh figure of the result, as the dashboard draws it

`figure` and `dashboard` need Bokeh and Panel, which are imported only when one of them is called.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

import granchain_core
from granchain_core import __version__ as __version__
from granchain_core.former_names import present

if TYPE_CHECKING:
    from granchain_core import *  # noqa: F403

    from .notebook import Dashboard, dashboard
    from .pictures import figure

#: Public names that the core does not have, each with the module of this package that defines it.
_OWN = {"Dashboard": "notebook", "dashboard": "notebook", "figure": "pictures"}

__all__ = [*granchain_core.__all__, "Dashboard", "dashboard", "figure"]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name in _OWN:
        return getattr(importlib.import_module(f".{_OWN[name]}", __name__), name)
    if present(name) in granchain_core.__all__:
        return getattr(granchain_core, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names, for completion in an interpreter."""
    return [*__all__, "__version__"]
