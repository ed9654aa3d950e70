"""The command line: one module for each command (`commands.py` lists them), and modules that the commands share.

Command names, JSON keys and exit statuses are a contract for scripts. The statuses are 0 done, 2 bad input, 3 the
computation failed, 130 cancelled by Ctrl-C, 143 terminated by SIGTERM.

Nothing is imported here: the commands take a second to load, and Ctrl-C during that second must work as it does later.
`entry` therefore first takes over the signals (ending.py) and then loads the rest.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command in this process, by default that of its command line, and return the exit status."""
    import sys

    from .commands import do

    return do(list(sys.argv[1:] if arguments is None else arguments))


def entry() -> int:
    """Run `granchain` or `python -m app.cli`: `main` in a process of its own, which signals may end."""
    try:
        from . import ending

        ending.begin()
        return ending.leave(main())
    except KeyboardInterrupt:  # before the signals were taken over
        import os

        os.write(2, b"Cancelled.\n")
        os._exit(130)
