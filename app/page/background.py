"""What pages that work in the background have in common: words from their threads, and kernels that are waited for."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from granchain_core import Scene
from granchain_core.pieces import compile_piece

from ..serve.compiler import COMPILER
from ..serve.queues import Stop

if TYPE_CHECKING:
    from .controller import Controller


class Background:
    """A part of the page whose work goes on in a thread until it is done or its stop flag is set."""

    _page: Controller

    def _later(self, stop: Stop, action: Callable[..., None], *arguments: Any, **named: Any) -> None:
        """In the document's turn, unless other work or nothing is wanted by then."""

        def act() -> None:
            if not stop[0]:
                action(*arguments, **named)

        self._page.later(act)

    def _compiled(self, scene: Scene, pieces: Iterable[str], stop: Stop, say: Callable[[str], None]) -> bool:
        """Wait for pieces of the kernels, saying so; False when cancelled before."""
        for piece in pieces:
            if not COMPILER.has(scene, piece):
                self._later(stop, say, "compiling")
            if not COMPILER.await_piece(scene, piece, stop):
                return False
            compile_piece(scene, piece)
        return True
