"""The pictures of one dashboard: computed for the knobs as they are, sent at the pace of the browser."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from bokeh.document import Document

from granchain_core import Cancelled, Run, Scene, Settled, State, settling
from granchain_core.warm import LIVE

from ..frames import samples_for
from ..serve.compiler import COMPILER, PICTURE_PIECES, compiling_words
from ..serve.pacing import FramePacer
from ..serve.queues import LatestWins, Stop
from ..serve.websocket import batched_messages
from ..session.energy_residual import with_account
from ..session.host import Host
from ..session.live import LivePicture, LiveRun
from .layout import Views
from .show import show_live, show_settled


class Pictures:
    """Settled pictures and the live run. `note` takes a sentence that the next picture takes away.

    `arrived` is called with every settled picture, before it is sent.
    """

    def __init__(self, document: Document, host: Host, views: Views, note: Callable[[str], None],
                 arrived: Callable[[Settled], None]) -> None:
        self._document = document
        self._host = host
        self._session = host.session
        self._views = views
        self._note = note
        self._settled_arrived = arrived
        self._jobs = LatestWins(partial(host.next_tick, self._arrived), partial(host.next_tick, host.failed))
        self._pacer: FramePacer[Settled | LivePicture] = FramePacer(self._send, self.idle)
        self.live: LiveRun | None = None

    @property
    def busy(self) -> bool:
        """Whether a picture is being computed; work that can wait then waits."""
        return self._jobs.busy

    @property
    def awaiting_picture(self) -> bool:
        """Whether a knob has moved and its steady picture is not there yet; a live run is at work all the time."""
        return self._jobs.busy and self.live is None

    def close(self) -> None:
        """The visitor left."""
        self._jobs.close()

    # Computing

    def compute(self, start: State | None = None) -> None:
        """Compute a picture for the knobs as they are now, from `start` or from where the visitor chose."""
        if self._session.mode == "live":
            if self.live is not None:
                self.live.change(self._session.scene)
            if self._session.playing:
                self.idle()
            else:
                self.advance(1)  # what stands still still shows the chain of these knobs
        else:
            self._jobs.submit(partial(self._settled, self._session.scene, start))

    def advance(self, samples: int | None = None) -> None:
        """Take the next step of the live run: `samples`, or as many as the viewing time asks for."""
        self._jobs.submit(partial(self._live_step, samples))

    def run(self) -> Run | None:
        """What is on the screen, as a run."""
        if self.live is not None:
            return self.live.window_run()
        return None if self._session.picture is None else self._session.picture.run

    # In a worker thread

    def _settled(self, scene: Scene, start: State | None, stop: Stop) -> Iterator[Settled]:
        """Pictures on the way to the steady state, once the kernels are compiled."""
        self._await_live_kernels(scene, stop)
        self._session.started_from = start or self._session.previous_state()
        pictures = settling(scene, start=self._session.started_from, samples=samples_for(scene), stop=stop)
        yield next(pictures)
        if all(COMPILER.await_piece(scene, piece, stop) for piece in PICTURE_PIECES):
            for picture in pictures:
                yield picture
                if picture.final and self._session.account:
                    yield with_account(picture, stop)

    def _await_live_kernels(self, scene: Scene, stop: Stop) -> None:
        """Wait until another process has compiled the live kernels: this one must not. Raises `Cancelled`."""
        if not COMPILER.has(scene, LIVE):
            words = compiling_words("the kernels for this set of effects", 10).capitalize()
            self._host.next_tick(self._note, f"{words}; the picture then appears by itself.")
            for piece in PICTURE_PIECES:
                COMPILER.ask(scene, piece)
            if not COMPILER.await_piece(scene, LIVE, stop):
                raise Cancelled

    def _live_step(self, samples: int | None, stop: Stop) -> Iterator[LivePicture]:
        live = self.live
        if live is not None:
            self._await_live_kernels(self._session.scene, stop)
            yield live.advance(samples) if samples else live.step(self._session.speed)

    # To the browser

    def _arrived(self, picture: Settled | LivePicture) -> None:
        live = isinstance(picture, LivePicture)
        if live != (self._session.mode == "live") or picture.run.scene.name != self._session.scene.name:
            return
        if isinstance(picture, Settled):
            self._session.picture = picture
            self._settled_arrived(picture)
        if self._session.notice:
            self._note("")
        self._pacer.offer(picture)

    def _send(self, number: int, picture: Settled | LivePicture) -> None:
        with batched_messages(self._document):
            if isinstance(picture, Settled):
                show_settled(self._views, number, picture)
            else:
                show_live(self._views, number, picture, self._session.playing)

    def painted(self, number: object) -> None:
        """The browser says that picture `number` is on the screen."""
        self._pacer.painted(number)

    def restart(self) -> None:
        """The page is visible again: forget outstanding acknowledgements, which will never come."""
        self._pacer.restart()

    def idle(self) -> None:
        """The browser has painted everything: in live mode, take the next step."""
        if self._session.mode == "live" and self._session.playing and not self._pacer.waits:
            self.advance()
