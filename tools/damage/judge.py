"""The verdict on one harmed file, by a reader in a separate process that is killed if it hangs."""

from __future__ import annotations

import multiprocessing
import tempfile
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from granchain_core import BadInput

from .harms import DAMAGE, HARMS, LEADING, SWAPPED, harm
from .kinds import KINDS, made, told

#: Time after which a reader counts as hung [s]: three times the limit of a child that reads an old file.
HANGS = 30.0
REFUSED, SAME, WRONG, OTHER, TRACEBACK, HANG = (
    "refused with a sentence", "read, the same numbers", "wrong numbers", "forged values read", "traceback", "hang")
OUTCOMES = (REFUSED, SAME, WRONG, OTHER, TRACEBACK, HANG)


@dataclass(frozen=True)
class Verdict:
    """The outcome for one harmed file."""

    kind: str
    sealed: bool
    harm: str
    index: int
    outcome: str
    sentence: str


def read(kind: str, path: Path, name: str, true: Any) -> tuple[str, str]:
    """Read a file that suffered harm `name`; return the outcome and the reader's sentence."""
    try:
        found = told(KINDS[kind].read(path))
    except BadInput as refusal:
        sentence = str(refusal)
        single = sentence.endswith(".") and len(sentence) < 800
        return (REFUSED if single else TRACEBACK), sentence
    except BaseException as problem:  # any other exception is what this tool looks for
        return TRACEBACK, repr(problem)
    if found == true:
        return SAME, ""
    return (WRONG if name in (*DAMAGE, SWAPPED, *LEADING) else OTHER), ""


def _work(pipe: Connection) -> None:
    """Read files in a separate process as long as they arrive."""
    while True:
        kind, path, name, true = pipe.recv()
        pipe.send(read(kind, Path(path), name, true))


class Reader:
    """A process that reads files; it is restarted when a file keeps it too long or makes it end."""

    def __init__(self) -> None:
        self._process: Any = None

    def read(self, *question: Any) -> tuple[str, str]:
        """Do the same as the function `read`, in the process."""
        if self._process is None:
            context = multiprocessing.get_context("spawn")
            self._pipe, theirs = context.Pipe()
            self._process = context.Process(target=_work, args=(theirs,), daemon=True)
            self._process.start()
            theirs.close()
        self._pipe.send(question)
        try:
            if self._pipe.poll(HANGS):
                return self._pipe.recv()
            outcome = HANG, f"more than {HANGS:g} s"
        except EOFError:
            outcome = TRACEBACK, "the process ended"
        self.close()
        return outcome

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None


def verdicts(kind: str, sealed: bool, count: int, seed: int) -> Any:
    """Yield the verdicts on harms 0 to `count` − 1 of a kind of file, with or without its seal."""
    with tempfile.TemporaryDirectory() as folder:
        source = made(KINDS[kind], Path(folder))[0 if sealed else 1]
        true, reader = told(KINDS[kind].read(source)), Reader()
        for index in range(count):
            rng, name = np.random.default_rng([seed, index]), HARMS[index % len(HARMS)]
            target = Path(folder) / "harmed.h5"
            target.unlink(missing_ok=True)
            harm(source, target, name, sealed, rng)
            yield Verdict(kind, sealed, name, index, *reader.read(kind, str(target), name, true))
        reader.close()
