"""The computation of the main picture in worker threads; `main_picture.py` requests it and shows the results."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial

import numpy as np

from granchain_core import Cancelled, OverBudget, Scene, Settled, State, settling
from granchain_core.precompile.pieces import FIXED_STEP_KERNELS, MOTION_KERNELS

from ..frames import samples_for
from ..serve.compiling.compiler import COMPILER, PICTURE_PIECES, compiling_words
from ..serve.computing.cpu_time import CpuTime
from ..serve.computing.shared import Shared
from ..serve.computing.turns import TurnFlag
from ..serve.computing.worker_pools import PICTURES
from ..serve.monitoring.picture_stages import PictureStages
from ..session.budget import WHOLE_PICTURE, RefusedPicture, TooLong, check_first_picture
from ..session.energy_account import account_piece, with_account
from ..session.host import Caller
from ..session.live import LiveRun, LiveStep


def size_of(settled: Settled) -> int:
    """Return the memory of a picture [bytes]: its arrays and a small overhead."""
    arrays = [*vars(settled.run).values(), settled.state.displacement, settled.state.velocity]
    return 4096 + sum(array.nbytes for array in arrays if isinstance(array, np.ndarray))


#: Pictures of all sessions. The last picture of each scene is cached for later sessions, in at most 100 MB.
PICTURES_SHARED: Shared[Settled] = Shared(PICTURES, 100_000_000, size_of, lambda pictures: pictures[-1:])


def _computed(scene: Scene, initial_state: State | None, most: float, stages: PictureStages,
              stop: TurnFlag) -> Iterator[Settled]:
    """Yield successive pictures on the way to the steady state; raise `TooLong` after `most` seconds of CPU time."""
    began = time.thread_time()
    pictures = settling(scene, start=initial_state, samples=samples_for(scene), stop=stop)
    first = next(pictures)
    stages.turn_wait = stop.waited
    yield first
    with stop.released():
        compiled = all(COMPILER.await_piece(scene, piece, stop) for piece in PICTURE_PIECES)
    if not compiled:
        raise Cancelled
    for settled in pictures:
        yield settled
        if time.thread_time() - began > most and not settled.final:
            raise TooLong


@dataclass(frozen=True)
class SettledRequest:
    """The values of a request for a settled picture. They are kept here because workers do not read the session."""

    scene: Scene
    #: The state in which the motion begins; None means rest.
    initial_state: State | None
    #: Whether the picture is computed no matter how long it takes.
    insisted: bool
    #: Whether the energy residual is computed as well.
    account: bool


@contextmanager
def _refusing(scene: Scene) -> Iterator[None]:
    """Turn the failure of a picture that takes too long into a `RefusedPicture` of its scene."""
    try:
        yield
    except (OverBudget, TooLong) as problem:
        raise RefusedPicture(scene, str(problem)) from None


class PictureWork:
    """The work of threads for one session's pictures. It neither reads the session nor writes to the page.

    `show_notice` is called with a sentence, `note_initial_state` with the state in which a settled motion begins (None
    for rest); both are called with the document locked.
    """

    def __init__(self, caller: Caller, cpu_time: CpuTime, show_notice: Callable[[str], None],
                 note_initial_state: Callable[[State | None], None]) -> None:
        self._caller = caller
        self._cpu_time = cpu_time
        self._show_notice = show_notice
        self._note_initial_state = note_initial_state

    def settled_pictures(self, request: SettledRequest, stages: PictureStages, stop: TurnFlag) -> Iterator[Settled]:
        """Yield the pictures of a request; one that takes too long is refused."""
        with _refusing(request.scene):
            yield from self._pictures_of(request, stages, stop)

    def _pictures_of(self, request: SettledRequest, stages: PictureStages, stop: TurnFlag) -> Iterator[Settled]:
        """Yield the pictures of a request, each better than the last; the final one may have an energy account.

        Pictures from rest are shared with other sessions, unless the visitor has insisted on them.
        """
        scene, initial_state, insisted = request.scene, request.initial_state, request.insisted
        if not insisted:
            check_first_picture(scene)
        self._await_first_kernels(scene, stop)
        stages.end("kernels")
        self._caller.next_tick(self._note_initial_state, initial_state)
        key = None if initial_state is not None or insisted else scene
        most = math.inf if insisted else WHOLE_PICTURE
        with closing(PICTURES_SHARED.follow(key, partial(_computed, scene, initial_state, most, stages), stop,
                                            self._cpu_time)) as pictures:
            latest: Settled | None = None
            for latest in pictures:
                yield latest
        if request.account and latest is not None:
            if not COMPILER.await_piece(scene, account_piece(scene), stop):
                raise Cancelled
            with stop.held():
                latest = with_account(latest, stop)
            yield latest

    def live_step(self, newest_run: Callable[[], LiveRun | None], samples: int | None, speed: float,
                  insisted: Scene | None, stages: PictureStages, stop: TurnFlag) -> Iterator[LiveStep]:
        """Yield the next step of the live run: by `samples`, or by the viewing time that has passed at `speed`."""
        live = newest_run()  # another run may have begun while this step waited
        if live is None:
            return
        scene = live.scene
        with _refusing(scene):
            if scene != insisted:
                check_first_picture(scene)
        self._await_first_kernels(scene, stop)
        stages.end("kernels")
        with live.flag.held(is_new=True):
            stages.end("turn")
            result = live.advance(samples) if samples else live.step(speed)
        yield result

    def _await_first_kernels(self, scene: Scene, stop: TurnFlag) -> None:
        """Wait for the kernels of the first picture. Raises `Cancelled`.

        Another process compiles these kernels, and the other kernels of the picture and its curve.
        """
        needed = MOTION_KERNELS if scene.cuts_tension else (FIXED_STEP_KERNELS,)  # dop853 settles tension cuts
        if not COMPILER.has(scene, *needed):
            words = compiling_words("the kernels for this set of effects", FIXED_STEP_KERNELS).capitalize()
            self._caller.next_tick(self._show_notice, f"{words}; the picture then appears automatically.")
            for piece in PICTURE_PIECES:
                COMPILER.ask(scene, piece)
            if not all(COMPILER.await_piece(scene, piece, stop) for piece in needed):
                raise Cancelled
