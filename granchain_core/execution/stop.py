"""`Stop`, which ends a computation before it is done."""

from __future__ import annotations

import numpy as np

from ..errors import Cancelled


class Stop:
    """Asks a computation in another thread to end, which then raises `Cancelled` or returns its finished part.

    Attributes
    ----------
    flag : numpy.ndarray, shape (1,)
        The byte that compiled code reads between steps.

    Examples
    --------
    >>> from granchain_core import Stop, run, scene
    >>> stop = Stop()
    >>> stop.set()
    >>> run(scene("sec2"), stop=stop)
    Traceback (most recent call last):
    granchain_core.errors.Cancelled
    """

    __slots__ = ("flag",)

    def __init__(self) -> None:
        self.flag = np.zeros(1, dtype=np.uint8)

    def set(self) -> None:
        """Ask the computation to end. May be called from any thread, and cannot be undone."""
        self.flag[0] = 1

    def pause(self) -> None:
        """Called by the computing thread between parts of a computation, a few hundredths of a second apart.

        This hook does nothing here; the server's stop flag overrides it to give up its turn.
        """

    def __bool__(self) -> bool:
        return bool(self.flag[0])

    def check(self) -> None:
        """Raise `Cancelled` if the computation has been asked to end."""
        if self.flag[0]:
            raise Cancelled
