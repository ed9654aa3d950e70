"""`--out FILE --resume`: checkpoints of an interrupted command in the folder FILE.blocks."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from granchain_core import BadInput, Cancelled
from granchain_core.execution.checkpoints import CheckpointFolder, folder_of

from . import ending
from .common import say

Result = TypeVar("Result")


def add_resume(parser: argparse.ArgumentParser, what: str) -> None:
    """Add `--resume`."""
    parser.add_argument("--resume", action="store_true",
                        help=f"continue an interrupted {what}; --out names its file")


def finished(arguments: argparse.Namespace, what: str, load: Callable[[str], Result],
             same: Callable[[Result], bool]) -> Result | None:
    """With --resume, return the result in --out if it is the complete result of these options; otherwise None.

    Its blocks may still exist, if the command was killed between writing the result and removing them. Raise `BadInput`
    for --resume without --out, and for a file with another result if there are no blocks to continue from.
    """
    if arguments.out:
        ending.note_checkpoints(str(folder_of(arguments.out)))
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
        if unfinished:  # an older file, which this result will replace
            return None
        raise
    if not same(result):
        if unfinished:
            return None
        raise BadInput(f"{arguments.out} is a finished {what} that was computed with other options; give another "
                       "--out.")
    say(f"{arguments.out} is already finished; nothing was computed.")
    return result


@contextmanager
def writing_checkpoints(folder: CheckpointFolder[Any] | None, done: Callable[[], str]) -> Iterator[None]:
    """Compute in this block and write the pieces finished so far, however the block ends.

    After a signal, the command's last message is the sentence of `done`, which says how many pieces there are.
    """
    try:
        yield
    except (Cancelled, KeyboardInterrupt):
        if folder is None:
            raise
        folder.write()
        if not folder.path.exists():
            raise
        raise Cancelled(f"{done()} are kept in {folder.path}; continue with --resume") from None
    except BaseException:
        if folder is not None:
            folder.write()
        raise
