"""The main picture, computed for the present knobs and sent at the browser's pace."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from granchain_core import Run, Settled, State

from ..frames import Frames, prepared_frames
from ..serve.computing.latest_wins import LatestWins
from ..serve.computing.turns import TurnFlag
from ..serve.connection.pacing import PicturePacer
from ..serve.monitoring.metrics import METRICS
from ..serve.monitoring.picture_stages import PictureStages
from ..session.host import PageHost
from ..session.live import LiveRun, LiveStep
from .layout import Views
from .picture_requests import PictureRequest, PictureRequests
from .picture_work import PictureWork, SettledRequest
from .show import show_live, show_regime, show_settled


class _Answer(NamedTuple):
    """A picture from a worker, and the request that it answers; None for a live step that no request awaits.

    The first picture of a request has its stages; another that takes its place before it is sent inherits them.
    """

    picture: Settled | LiveStep
    request: PictureRequest | None
    stages: PictureStages | None


#: A computation, given the stages of its first picture and its stop flag.
_Work = Callable[[PictureStages, TurnFlag], Iterator[Settled | LiveStep]]


class MainPicture:
    """Computes and sends settled pictures and the live run.

    `show_notice` shows a message that the next picture clears. `picture_ready` is called with every settled picture
    before the picture waits for the browser.
    """

    def __init__(self, host: PageHost, views: Views, show_notice: Callable[[str], None],
                 picture_ready: Callable[[Settled], None]) -> None:
        self._host = host
        self._session = host.session
        self._views = views
        self._show_notice = show_notice
        self._picture_ready = picture_ready
        self._jobs = LatestWins(self._keep_newest, partial(host.next_tick, self._failed), self._session.cpu_time)
        self._work = PictureWork(host, self._jobs.cpu_time, show_notice, self._note_initial_state)
        self._pacer: PicturePacer[Settled | LiveStep] = PicturePacer(self._send, self.next_live_step)
        self._live: LiveRun | None = None
        self._lock = threading.Lock()
        self._newest: _Answer | None = None
        self._accepted: Settled | LiveStep | None = None
        #: The settled picture that was sent last; None while a live run is shown.
        self._sent: Settled | None = None
        self._requests = PictureRequests()
        #: Frames of the last pictures. The cache of `prepared_frames` has only weak references, so without these the
        #: event loop would prepare the frames again.
        self._frames: deque[Frames] = deque(maxlen=2)
        host.on_close(self._close)

    @property
    def busy(self) -> bool:
        """Whether a picture is being computed, for which other work waits if it can."""
        return self._jobs.busy

    @property
    def awaiting_picture(self) -> bool:
        """See `PageHost.awaiting_picture`; a live run computes all the time and does not count."""
        return self._jobs.busy and self.live is None

    @property
    def live(self) -> LiveRun | None:
        """The live run; None while a settled motion is shown."""
        return self._live

    def begin_live(self, initial_state: State | None = None) -> None:
        """Begin a new live run of the session's scene, from `initial_state` or from rest."""
        self._live = LiveRun(self._session.scene, self._session.cpu_time, initial_state)

    def end_live(self) -> None:
        """End the live run: settled motions are shown from now on."""
        self._live = None

    def _close(self) -> None:
        """End all computations, because the session has ended."""
        self._jobs.close()
        if self.live is not None:
            self.live.close()

    # Computing

    def compute(self, initial_state: State | None = None) -> None:
        """Compute a picture for the present knobs, from `initial_state` or from the visitor's chosen start."""
        self._requests.begin()
        session, scene = self._session, self._session.scene
        if session.mode == "live":
            if self.live is not None:
                self.live.change(scene)
            if session.playing:
                self.next_live_step()
            else:
                self.advance(1)  # a paused chain also shows the new knobs
        else:
            self._submit(partial(self._work.settled_pictures, SettledRequest(
                scene, initial_state or session.previous_state(scene), scene == session.insisted,
                session.energy_account)))

    def advance(self, samples: int | None = None) -> None:
        """Take the next step of the live run: by `samples`, or by the viewing time that has passed."""
        self._submit(partial(self._work.live_step, lambda: self.live, samples, self._session.speed,
                             self._session.insisted))

    def _submit(self, work: _Work) -> None:
        """Compute `work` next; its pictures answer the last request."""
        self._jobs.submit(partial(self._answers, work, self._requests.last, self._requests.submitted()))

    def shown_run(self) -> Run | None:
        """Return the motion on the screen as a run, if there is one."""
        if self.live is not None:
            return self.live.window_run()
        return None if self._session.settled is None else self._session.settled.run

    def _note_initial_state(self, initial_state: State | None) -> None:
        """Note the state in which the motion begins, before the first picture arrives; document locked."""
        if initial_state is not self._session.initial_state:
            self._session.initial_state = initial_state
            self._host.address_changed()

    # In a worker thread

    @staticmethod
    def _answers(work: _Work, request: PictureRequest | None, stages: PictureStages | None,
                 stop: TurnFlag) -> Iterator[_Answer]:
        """Yield the pictures of `work`, each with the request that it answers, the first with its stages."""
        if stages is not None:
            stages.end("turn")
        for picture in work(stages or PictureStages(), stop):
            if stages is not None:
                stages.computed()
            yield _Answer(picture, request, stages)
            stages = None

    def _keep_newest(self, result: object) -> None:
        """Keep a new picture for the event loop; it replaces an older one that the loop has not fetched yet."""
        assert isinstance(result, _Answer)
        if isinstance(result.picture, Settled):
            self._frames.append(prepared_frames(result.picture.run))
        if result.stages is not None:
            result.stages.end("prepare")
        with self._lock:
            older = self._newest
            if older is not None and result.stages is None:
                result = result._replace(stages=older.stages)
            first, self._newest = older is None, result
        if first:
            self._host.next_tick(self._take_newest)

    # To the browser

    def _take_newest(self) -> None:
        """Fetch and accept the newest picture from a worker."""
        with self._lock:
            newest, self._newest = self._newest, None
        if newest is not None:
            self._accept(*newest)

    def _accept(self, result: Settled | LiveStep, request: PictureRequest | None = None,
                stages: PictureStages | None = None) -> None:
        """Offer a picture to the browser, if it belongs to the present mode and scene."""
        live = isinstance(result, LiveStep)
        if live != (self._session.mode == "live") or result.run.scene.name != self._session.scene.name:
            return
        self._say_if_busy(self._requests.accepted(request, stages))
        if isinstance(result, Settled):
            self._session.settled = result
            self._picture_ready(result)
        if self._session.notice:
            self._show_notice("")
        self._accepted = result
        self._pacer.offer(result)
        if live:
            self.next_live_step()  # so that two are in flight from the first step on, even before a knob is moved

    def _failed(self, error: Exception) -> None:
        """Report a failure."""
        self._requests.failed()
        self._host.show_failure(error)

    def _say_if_busy(self, seconds: float | None) -> None:
        """Say that a request took so long because the server is busy with many sessions; None for no request."""
        if seconds is not None:
            words = f"The server is busy: this picture took {seconds:.1f} s." if METRICS.busy else ""
            self._views.status_line.update_state(busy=words)

    def _send(self, number: int, result: Settled | LiveStep) -> None:
        METRICS.count("pictures")
        self._requests.sent(number)
        if isinstance(result, Settled):
            self._sent = result
            show_settled(self._views, number, result)
        else:
            self._sent = None
            show_live(self._views, number, result, self._session.playing)

    def show_regime(self) -> None:
        """Update the status line, since the curve may now show on which peak or valley the motion lies."""
        if self._sent is not None:
            show_regime(self._views, self._sent)

    def painted(self, number: object, browser_ms: object = None) -> None:
        """Note that picture `number` is on the screen; the browser's script took `browser_ms` [ms] to draw it."""
        if isinstance(number, int):
            self._requests.painted(number, browser_ms)
            self._pacer.painted(number)

    def redraw(self) -> None:
        """Send the picture on the screen again, drawn differently; a running chain sends its next one anyway."""
        shown, live = self._accepted, self.live is not None
        if shown is None or isinstance(shown, LiveStep) != live or (live and self._session.playing):
            return
        if shown.run.scene.name == self._session.scene.name:
            self._pacer.offer(shown)

    def restart(self) -> None:
        """Stop waiting for acknowledgements of pictures in flight, because the page is visible again."""
        self._requests.forget_in_flight()
        self._pacer.restart()

    def next_live_step(self) -> None:
        """Take the next step of a running chain, unless the window of pictures in flight is full."""
        if self._session.mode == "live" and self._session.playing and not self._pacer.is_full:
            self.advance()
