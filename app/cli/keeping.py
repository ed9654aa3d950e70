"""`--out FILE --resume`: checkpoints of an interrupted command in the folder FILE.blocks."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from granchain_core import BadInput, Cancelled
from granchain_core.execution.checkpoints import Kept, folder_of

from . import ending
from .common import say

Result = TypeVar("Result")


def add_resume(parser: argparse.ArgumentParser, what: str) -> None:
    """Add `--resume`."""
    parser.add_argument("--resume", action="store_true",
                        help=f"go on with a {what} that was interrupted; --out names its file")


def finished(arguments: argparse.Namespace, what: str, load: Callable[[str], Result],
             same: Callable[[Result], bool]) -> Result | None:
    """With --resume, the result in --out if the file has the complete result of these options; else None.

    Its blocks may still stand, if the command was killed between writing the result and removing them. Raises
    `BadInput` for --resume without --out, and for another result where there are no blocks to go on with.
    """
    if arguments.out:
        ending.keeps(str(folder_of(arguments.out)))
    if not arguments.resume:
        return None
    if not arguments.out:
        raise BadInput(f"--resume needs --out FILE, the file of the {what} that was interrupted.")
    if not Path(arguments.out).exists():
        return None
    unfinished = folder_of(arguments.out).exists()
    try:
        result = load(arguments.out)
    except BadInput:
        if unfinished:  # an older file that this result will replace
            return None
        raise
    if not same(result):
        if unfinished:
            return None
        raise BadInput(f"{arguments.out} is a finished {what} that was computed with other options; give another "
                       "--out.")
    say(f"{arguments.out} is finished already; nothing was computed.")
    return result


@contextmanager
def keeping(kept: Kept[Any] | None, done: Callable[[], str]) -> Iterator[None]:
    """Compute in this block: however it ends, the pieces finished so far are written.

    After a signal the sentence of `done`, which says how many there are, is what the command says.
    """
    try:
        yield
    except (Cancelled, KeyboardInterrupt):
        if kept is None:
            raise
        kept.write()
        if not kept.folder.exists():
            raise
        raise Cancelled(f"{done()} are kept in {kept.folder}; go on with --resume") from None
    except BaseException:
        if kept is not None:
            kept.write()
        raise
