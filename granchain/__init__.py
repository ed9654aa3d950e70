"""`import granchain` is `import granchain_core`: the same public names, nothing of its own.

    import granchain
    result = granchain.run(granchain.scene("sec2").evolve(f=340.0))
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import granchain_core
from granchain_core import __all__ as __all__
from granchain_core import __version__ as __version__

if TYPE_CHECKING:
    from granchain_core import *  # noqa: F403


def __getattr__(name: str) -> Any:
    """A public name of granchain_core, imported when it is first asked for."""
    if name in __all__:
        return getattr(granchain_core, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """What there is, for completion in an interpreter."""
    return [*__all__, "__version__"]
