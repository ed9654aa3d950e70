"""Reading a file in a child process with limits, so that a damaged file cannot harm the program."""

from __future__ import annotations

import contextlib
import json
import math
import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np

from . import plain
from .plain import Refused, Stored

#: Time that opening and reading may take [s].
_SECONDS = 10
#: One second more is allowed for each of this many bytes of the file [bytes/s].
_BYTES_A_SECOND = 20_000_000
#: Longest answer that is not numbers [bytes].
_LONGEST = 64_000_000


class Child:
    """Reads a file as `Plain` does, in a child that ends with this object, after too long, or with this process."""

    def __init__(self, path: str) -> None:
        seconds = _SECONDS + Path(path).stat().st_size // _BYTES_A_SECOND
        self._seconds, self._late = seconds, False
        self._process = subprocess.Popen(
            [sys.executable, "-P", plain.__file__, os.path.abspath(path), str(seconds)], stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        self._clock = threading.Timer(seconds, self._end_late)
        self._clock.daemon = True
        self._clock.start()
        try:
            self._answer()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """End the child."""
        self._clock.cancel()
        self._process.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()  # type: ignore[union-attr]  # both are pipes
        self._process.wait()

    def attribute(self, path: str, name: str) -> float | int | str | None:
        """An attribute of the group or dataset at `path`; None where there is none. As `Plain.attribute`."""
        return self._ask("attribute", path, name)

    def stored(self, path: str) -> Stored | None:
        """Type, shape and unit of a dataset; None where there is none. As `Plain.stored`."""
        answer = self._ask("stored", path)
        return answer and Stored(str(answer["type"]), tuple(answer["shape"]), answer["units"])

    def names(self) -> list[str]:
        """The paths of all datasets in the file. As `Plain.names`."""
        return [str(name) for name in self._ask("names")]

    def words(self, path: str) -> list[str]:
        """One row of words. As `Plain.words`."""
        return [str(word) for word in self._ask("words", path)]

    def numbers(self, path: str, rows: int | None = None) -> np.ndarray:
        """The numbers of a dataset, of which only the first `rows` where that is given. As `Plain.numbers`."""
        answer = self._ask("numbers", path, rows)
        kind, shape = np.dtype(answer["type"]), tuple(answer["shape"])
        size = math.prod(shape) * kind.itemsize
        content = self._process.stdout.read(size)  # type: ignore[union-attr]
        if len(content) != size:
            raise self._ended()
        return np.frombuffer(bytearray(content), kind).reshape(shape)

    def _ask(self, *args: Any) -> Any:
        with contextlib.suppress(OSError):  # a child that has ended is told below
            self._process.stdin.write(json.dumps(args).encode() + b"\n")  # type: ignore[union-attr]
            self._process.stdin.flush()  # type: ignore[union-attr]
        return self._answer()

    def _answer(self) -> Any:
        line = self._process.stdout.readline(_LONGEST)  # type: ignore[union-attr]
        if not line.endswith(b"\n"):
            raise self._ended()
        answer = json.loads(line)
        if "refused" in answer:
            raise Refused(answer["refused"])
        return answer["found"]

    def _end_late(self) -> None:
        self._late = True
        self._process.kill()

    def _ended(self) -> Refused:
        """Why the child says nothing more."""
        self._process.kill()
        if self._late:
            return Refused(f"reading it took more than {self._seconds} s, as only a damaged file does")
        return Refused(f"HDF5 crashed on it (the process that read it ended with status {self._process.wait()})")
