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

#: Time allowed for opening and reading [s].
_SECONDS = 10
#: Bytes of the file for which one more second is allowed [bytes/s].
_BYTES_A_SECOND = 20_000_000
#: Longest non-numeric answer [bytes].
_LONGEST = 64_000_000


class Child:
    """Reads a file as `Plain` does, in a child process that ends with this object or process, or at a time limit."""

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
        """End the child process."""
        self._clock.cancel()
        self._process.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()  # type: ignore[union-attr]  # both are pipes
        self._process.wait()

    def attribute(self, path: str, name: str) -> float | int | str | None:
        """Return an attribute of the group or dataset at `path`; None if it is absent. As `Plain.attribute`."""
        return self._ask("attribute", path, name)

    def stored(self, path: str) -> Stored | None:
        """Return type, shape and unit of a dataset; None if it is absent. As `Plain.stored`."""
        answer = self._ask("stored", path)
        return answer and Stored(str(answer["type"]), tuple(answer["shape"]), answer["units"])

    def names(self) -> list[str]:
        """Return the paths of all datasets in the file. As `Plain.names`."""
        return [str(name) for name in self._ask("names")]

    def words(self, path: str) -> list[str]:
        """Read one row of words. As `Plain.words`."""
        return [str(word) for word in self._ask("words", path)]

    def numbers(self, path: str, rows: int | None = None) -> np.ndarray:
        """Read the numbers of a dataset, or only its first `rows` rows. As `Plain.numbers`."""
        answer = self._ask("numbers", path, rows)
        kind, shape = np.dtype(answer["type"]), tuple(answer["shape"])
        size = math.prod(shape) * kind.itemsize
        content = self._process.stdout.read(size)  # type: ignore[union-attr]
        if len(content) != size:
            raise self._ended()
        return np.frombuffer(bytearray(content), kind).reshape(shape)

    def _ask(self, *args: Any) -> Any:
        with contextlib.suppress(OSError):  # `_answer` reports a child that has ended
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
        """Return the reason why the child has stopped answering."""
        self._process.kill()
        if self._late:
            return Refused(f"reading it took more than {self._seconds} s, as only a damaged file does")
        return Refused(f"HDF5 crashed on it (the process that read it ended with status {self._process.wait()})")
