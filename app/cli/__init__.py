"""The command line: a module for each command (`commands.py` lists them), and what commands share.

Names, JSON keys and exit statuses are what others script against: 0 done, 2 bad input, 3 the computation failed,
130 cancelled by Ctrl-C, 143 by SIGTERM.

Nothing is imported here: the commands take a second to load, and Ctrl-C in that second must end as it does later.
`entry` therefore first says what signals do (ending.py), and then loads the rest.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command in this process, by default that of its command line; returns the exit status."""
    import sys

    from .commands import do

    return do(list(sys.argv[1:] if arguments is None else arguments))


def entry() -> int:
    """The entry of `granchain` and `python -m app.cli`: `main` in a whole process, which signals may end."""
    try:
        from . import ending

        ending.begin()
        return ending.leave(main())
    except KeyboardInterrupt:  # signals were not taken over yet
        import os

        os.write(2, b"Cancelled.\n")
        os._exit(130)
