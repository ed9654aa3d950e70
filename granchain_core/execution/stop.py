"""`Stop`: ends a computation before it is done."""

from __future__ import annotations

import numpy as np

from ..errors import Cancelled


class Stop:
    """Asks a computation in another thread to end; it then raises `Cancelled`, or returns what is finished.

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
        """Ask for the end; from any thread, and for good."""
        self.flag[0] = 1

    def pause(self) -> None:
        """Called between parts of a computation, some hundredths of a second apart, by the thread that computes.

        A hook: it does nothing here, and the server's flag gives up its turn in it.
        """

    def __bool__(self) -> bool:
        return bool(self.flag[0])

    def check(self) -> None:
        """Raise `Cancelled` if the end has been asked for."""
        if self.flag[0]:
            raise Cancelled
