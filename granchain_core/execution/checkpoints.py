"""Checkpoints: finished pieces of a long computation on disk, so that a killed process loses only unwritten pieces.

A folder next to the result, FILE.blocks, contains a head, which identifies the computation, and blocks of finished
pieces. Every file is written under a temporary name, synced and renamed, and begins with the SHA-256 of its content, so
that incomplete blocks are detected and computed again.
"""

from __future__ import annotations

import hashlib
import json
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, Generic, TypeVar

from ..errors import BadInput

#: Maximum number of pieces in one block.
BLOCK = 128
#: Time after which a smaller block is written [s].
SECONDS = 0.5
#: Consecutive blocks are at least this many times their writing time apart.
_SHARE = 20.0
#: Suffix of a block's file name.
_SUFFIX = ".block"
#: Version of the format.
_VERSION = 1

Piece = TypeVar("Piece")


def folder_of(out: str | Path) -> Path:
    """Return the folder of blocks of a result."""
    return Path(f"{out}.blocks")


def digest_of(described: dict[str, Any]) -> str:
    """Return the hash of a computation, formed from everything that affects its result."""
    return hashlib.sha256(json.dumps(described, sort_keys=True).encode()).hexdigest()[:16]


class CheckpointFolder(Generic[Piece]):
    """The folder of one computation, which grows as the computation proceeds. Any thread may add to it.

    `kind` names what is computed in one word, `digest` identifies it and `words` describe it to a person. `pack` turns
    pieces into the content of a block. The folder is created with the first block. With `newest_only`, a block replaces
    all earlier ones.
    """

    def __init__(self, out: str | Path, kind: str, digest: str, words: str,
                 pack: Callable[[list[Piece]], bytes], newest_only: bool = False) -> None:
        self.path = folder_of(out)
        self._kind, self._words, self._pack, self._newest_only = kind, words, pack, newest_only
        self._head = {"version": _VERSION, "digest": digest, "words": words}
        self._pieces: list[Piece] = []
        self._lock = threading.Lock()
        self._number, self._due = 0, time.monotonic() + SECONDS
        self._later: threading.Timer | None = None
        self._problem: BadInput | None = None

    def open(self, resume: bool) -> None:
        """Check the folder: an unfinished computation in it must be this one and be resumed. Raises `BadInput`."""
        try:
            if not self._head_file.exists():
                self._clear()  # without a head, blocks may be another computation's
                return
            if not resume:
                raise BadInput(f"{self.path} holds an unfinished {self._kind}; continue with --resume, or delete it.")
            head = self._read(self._head_file.name)
        except OSError as problem:
            raise self._denied(problem) from None
        if head is None:
            raise BadInput(f"{self._head_file} is damaged; delete {self.path} to start again.")
        header = json.loads(head)
        if (header.get("version"), header.get("digest")) != (_VERSION, self._head["digest"]):
            words = header.get("words", "of another version")
            raise BadInput(f"{self.path} holds another {self._kind}, {words}, not {self._words} with these knobs; "
                           f"add --resume to the command line of that {self._kind}, give another --out, or delete the "
                           "folder.")

    def blocks(self) -> Iterator[bytes]:
        """Yield the contents of the intact blocks in the order in which they were written."""
        for path in sorted(self.path.glob(f"*{_SUFFIX}")):
            content = self._read(path.name)
            if content is not None:
                yield content

    def add(self, piece: Piece) -> None:
        """Add a finished piece. It is written when a block is full, or after `SECONDS` at the latest.

        Raises `BadInput` if an earlier write failed.
        """
        with self._lock:
            if self._problem is not None:
                raise self._problem
            if self._newest_only:
                self._pieces.clear()
            self._pieces.append(piece)
            left = self._due - time.monotonic()
            if self._later is None and left > 0.0:
                self._later = threading.Timer(left, self._write_later)
                self._later.daemon = True
                self._later.start()
        if left <= 0.0 or len(self._pieces) >= BLOCK:
            self.write()

    def _write_later(self) -> None:
        try:
            self.write()
        except BadInput as problem:  # raised in the thread that adds the next piece
            self._problem = problem

    def write(self) -> None:
        """Write the pieces added since the last block. Raises `BadInput` if that is impossible."""
        with self._lock:
            self._later = None
            if not self._pieces:
                return
            began, content = time.monotonic(), self._pack(self._pieces)
            self._pieces.clear()
            self._number += 1
            name = f"{time.time_ns():x}-{os.getpid()}-{self._number}{_SUFFIX}"
            try:
                if self._number == 1:
                    self._begin()
                self._write(name, content)
                if self._newest_only:
                    self._clear(name)
            except OSError as problem:
                raise self._denied(problem) from None
            now = time.monotonic()
            self._due = now + max(SECONDS, _SHARE * (now - began))

    def remove(self) -> None:
        """Remove the folder once the result is written, the head last, so that any blocks left over are identified."""
        try:
            with self._lock:
                self._pieces.clear()
                self._clear()
            self._head_file.unlink(missing_ok=True)
            if self.path.exists():
                self.path.rmdir()
        except OSError as problem:
            raise BadInput(f"Cannot remove {self.path}: {problem.strerror or problem}.") from None

    @property
    def _head_file(self) -> Path:
        return self.path / f"{self._kind}.json"

    def _begin(self) -> None:
        self.path.mkdir(exist_ok=True)
        if not self._head_file.exists():
            self._write(self._head_file.name, json.dumps(self._head).encode())

    def _clear(self, but: str = "") -> None:
        """Remove all blocks except `but`, and files that a killed process was writing."""
        for path in [*self.path.glob(f"*{_SUFFIX}"), *self.path.glob(".*.tmp")]:
            if path.name != but:
                path.unlink(missing_ok=True)

    def _write(self, name: str, content: bytes) -> None:
        temporary = self.path / f".{name}.{os.getpid()}.tmp"
        try:
            with temporary.open("wb") as file:
                file.write(hashlib.sha256(content).digest() + content)
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, self.path / name)
        except OSError:
            with suppress(OSError):
                temporary.unlink()
            raise
        folder = os.open(self.path, os.O_RDONLY)
        os.fsync(folder)  # the new name is stored in the folder, which is synced separately
        os.close(folder)

    def _read(self, name: str) -> bytes | None:
        """Return the content of a file; None if its checksum does not match."""
        stored = (self.path / name).read_bytes()
        digest, content = stored[:32], stored[32:]
        return content if hashlib.sha256(content).digest() == digest else None

    def _denied(self, problem: OSError) -> BadInput:
        return BadInput(f"Cannot write {self.path}: {problem.strerror or problem}.")
