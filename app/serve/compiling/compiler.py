"""Compiling outside the server process, so that only the session that needs the kernels waits.

Numba holds the GIL while it compiles. Kernels that are not cached yet are therefore compiled in separate processes, and
the server then loads them from the cache. If such a process fails, the server does not compile in its place.
"""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
import threading
from concurrent.futures import Future, wait
from pathlib import Path

from granchain_core import Scene
from granchain_core.execution.stop import Stop
from granchain_core.precompile.pieces import COMPILE_SECONDS, CURVE_KERNELS, MOTION_KERNELS
from granchain_core.precompile.warm import compile_piece, is_warm, structure

from ..computing.worker_pools import COMPILATIONS, LOADING

#: Time between two checks of a stop flag while another process compiles [s].
_STOP_CHECK_INTERVAL = 0.05

#: Processes that are started for a piece if each is killed, for example because memory is short.
ATTEMPTS = 3

log = logging.getLogger("granchain")

#: The kernels of the main picture and its curve.
PICTURE_PIECES = (*MOTION_KERNELS, CURVE_KERNELS)
_ROOT = Path(__file__).resolve().parents[3]


def compiling_words(what: str, piece: str) -> str:
    """Return a sentence on what is being compiled, and how long the longest `piece` takes."""
    return f"compiling {what}: about {COMPILE_SECONDS[piece]} s, only the first time on this computer"


class CompilationFailed(Exception):
    """Kernels that no process has compiled."""


def _compile(scene: Scene, piece: str) -> None:
    """Compile in another process; in a new one, up to `ATTEMPTS` in all, if it is killed or cannot be started.

    Raises `CompilationFailed`. A process that ends by itself with an error would do so again, so it has one attempt.
    """
    command = [sys.executable, "-m", f"{__package__}.compiling_process", str(os.getpid()), piece]
    for attempt in range(1, ATTEMPTS + 1):
        try:  # in its own process session, out of reach of a terminal's Ctrl-C; its stderr is the server's
            ended = subprocess.run(command, input=json.dumps(scene.to_json()), text=True, cwd=_ROOT, check=False,
                                   stdout=subprocess.DEVNULL, start_new_session=True)
        except OSError as problem:
            reason, again = f"its process could not be started ({problem})", True
        else:
            if ended.returncode == 0:
                return
            reason, again = f"its process ended with status {ended.returncode}", ended.returncode < 0
        log.warning("compiling %s failed: %s, attempt %d of %d", piece, reason, attempt, ATTEMPTS)
        if not again:
            break
    raise CompilationFailed(f"compiling {piece} failed: {reason}")


def _log_failure(ended: Future[None]) -> None:
    """Log a failure that no session waits for."""
    error = ended.exception()
    if error is not None:
        log.error("loading kernels ahead of time failed", exc_info=error)


class Compiler:
    """Compiles kernels in other processes: each piece once, and again if it failed."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._compilations: dict[tuple[str, str], Future[None]] = {}
        self._known: set[tuple[str, str]] = set()
        self._loaded: set[tuple[str, str]] = set()

    def has(self, scene: Scene, *pieces: str) -> bool:
        """Return whether these kernels are compiled for the scene's structure and only need to be loaded."""
        missing = [piece for piece in pieces if (structure(scene), piece) not in self._known]
        if missing and not is_warm(scene, missing):
            return False
        self._known.update((structure(scene), piece) for piece in missing)
        return True

    def ask(self, scene: Scene, piece: str) -> Future[None]:
        """Start compiling in another process, unless that is under way or done. A failed piece is tried again."""
        key = structure(scene), piece
        with self._lock:
            compilation = self._compilations.get(key)
            if compilation is None or (compilation.done() and compilation.exception() is not None):
                compilation = self._compilations[key] = COMPILATIONS.submit(_compile, scene, piece)
            return compilation

    def await_piece(self, scene: Scene, piece: str, stop: Stop) -> bool:
        """Wait for these kernels in a worker thread; return False if the stop flag was set first."""
        if self.has(scene, piece):
            return True
        compilation = self.ask(scene, piece)
        while not wait([compilation], timeout=_STOP_CHECK_INTERVAL).done:
            if stop:
                return False
        compilation.result()
        return True

    def load(self, scene: Scene, piece: str) -> None:
        """Load compiled kernels into this process now instead of at their first call."""
        key = structure(scene), piece
        if key not in self._loaded:
            compile_piece(scene, piece)
            self._loaded.add(key)

    def prepare(self, scene: Scene) -> None:
        """Compile and load this scene's kernels before the first session needs them."""
        for piece in PICTURE_PIECES:
            if not self.has(scene, piece):
                self.ask(scene, piece)
        LOADING.submit(self._load_all, scene).add_done_callback(_log_failure)

    def _load_all(self, scene: Scene) -> None:
        for piece in PICTURE_PIECES:
            if not self.has(scene, piece):
                self.ask(scene, piece).result()
            self.load(scene, piece)


class Requests:
    """The pieces that one session's work has asked for, each only once, so that a failing piece is not tried forever.

    Another session's work, or a picture, may try it again.
    """

    def __init__(self, compiler: Compiler) -> None:
        self._compiler = compiler
        self._compilations: dict[tuple[str, str], Future[None]] = {}

    def failure(self, scene: Scene, *pieces: str) -> Exception | None:
        """Ask for these kernels. Return the error if one could not be compiled; None while no failure is known."""
        for piece in pieces:
            key = structure(scene), piece
            if key not in self._compilations:
                self._compilations[key] = self._compiler.ask(scene, piece)
            compilation = self._compilations[key]
            error = compilation.exception() if compilation.done() else None
            if isinstance(error, Exception):
                return error
        return None


COMPILER = Compiler()
