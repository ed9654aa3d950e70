"""What happens on the page: messages from the parts come in, pictures and sentences go out."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from bokeh.document import Document

from granchain_core import BadInput, NumbersFailed, Run, Scene, Settled, State, settling

from ..pages.accuracy.page import AccuracyPage
from ..pages.branches.page import BranchesPage
from ..pages.check.page import HardPage
from ..pages.curve.page import Curves
from ..pages.effects.foundation import beside_kappa, foundation_words
from ..pages.effects.page import EffectsPanel
from ..pages.map.page import MapTab
from ..pages.observer.page import ObserverPage
from ..pages.stability.page import StabilityPage
from ..parts.knobs import knob_state
from ..serve.compiler import CERTIFIED, COMPILER, CURVE, LIVE, SENTENCE
from ..serve.pacing import Painter
from ..serve.queues import LatestWins, Stop
from ..serve.websocket import in_its_turn, in_one_go, send_at_once
from .energy_residual import with_account
from .exchange import Exchange
from .frames import samples_for
from .layout import Views
from .live import LivePicture, LiveRun
from .playback import Transport
from .session import SPEEDS, Session, presets, slider_range
from .show import show_live, show_settled
from .theme import Looks

log = logging.getLogger("granchain")


class Controller:
    """One page: its session, its views, its jobs. Everything here runs in the document's turn."""

    def __init__(self, document: Document, session: Session) -> None:
        self._document = document
        self.session = session
        self.views = Views(self.received, partial(self._guarded, self._choose_frequency))
        self.jobs = LatestWins(partial(self.later, self._arrived), partial(self.later, self.failed))
        self._painter: Painter[Settled | LivePicture] = Painter(self._send, self.idle)
        self.live: LiveRun | None = None
        self.curves = Curves(self.views, self.later, self.after, lambda: self.busy)
        self.exchange = Exchange(self)
        self.looks = Looks(self)
        self.observer = ObserverPage(self)
        self.accuracy = AccuracyPage(self)
        self.branches = BranchesPage(self)
        self.effects = EffectsPanel(self)
        self.hard = HardPage(self)
        self.stability = StabilityPage(self)
        self.map = MapTab(self)
        self.parts = (self.accuracy, self.branches, self.effects, self.hard, self.map, self.observer, self.stability)
        self.covered = False
        self._actions: dict[str, Callable[[dict[str, Any]], None]] = {
            "ping": lambda _: self.views.chain.tell(type="pong"),
            "ready": self._ready, "visible": lambda _: self._painter.restart(),
            "painted": lambda m: self._painter.painted(m.get("number")),
            "set": self._set, "restore": self._restore, "scene": self._scene,
            "understood": self._understood, "cover": self._cover,
            **Transport(self).actions, **self.exchange.actions, **self.looks.actions,
            **{name: action for part in self.parts for name, action in part.actions.items()},
        }

    # Coming in and going out

    def received(self, message: dict[str, Any]) -> None:
        """A message from the browser: nothing in it is trusted."""
        name = message.get("do")
        action = self._actions.get(name) if isinstance(name, str) else None
        if action is None:
            self.say(f"The page sent a request {str(name)[:40]!r} that is not known here; reload the page.")
            return
        in_its_turn(self._document, partial(self._guarded, action, message))

    def _guarded(self, action: Callable[..., None], *arguments: Any) -> None:
        try:
            action(*arguments)
        except Exception as error:
            self.failed(error)

    def later(self, action: Callable[..., None], *arguments: Any) -> None:
        """Do something in the document's turn; callable from any thread."""
        self._document.add_next_tick_callback(partial(self._guarded, action, *arguments))

    def after(self, milliseconds: int, action: Callable[..., None], *arguments: Any) -> None:
        """Do something a little later."""
        self._document.add_timeout_callback(partial(self._guarded, action, *arguments), milliseconds)

    def say(self, sentence: str) -> None:
        """One sentence for the visitor, until the next valid action; an empty one takes it away."""
        self.session.sentence = sentence
        self._show_sentences()

    def note(self, notice: str) -> None:
        """One sentence that the next picture takes away."""
        self.session.notice = notice
        self._show_sentences()

    def _show_sentences(self) -> None:
        self.views.badge.display(sentence=f"{self.session.sentence} {self.session.notice}".strip())

    def failed(self, error: Exception) -> None:
        """The last good picture stays, and one sentence says what happened."""
        if isinstance(error, BadInput):
            self.say(str(error))
        elif isinstance(error, NumbersFailed):
            self.note(error.sentence)
        else:
            log.error("unexpected failure", exc_info=error)
            self.say(f"Something went wrong inside granchain ({type(error).__name__}); the last picture "
                     "stays. Move the knob back or reset, and please report it.")

    def close(self, session_context: object) -> None:
        """The visitor left."""
        for part in (self.jobs, self.curves, *self.parts):
            part.close()

    @property
    def busy(self) -> bool:
        """Whether a picture is being computed; what can wait, waits."""
        return self.jobs.busy

    @property
    def unsettled(self) -> bool:
        """Whether a knob has moved and its steady picture is not there yet; a live run is at work all the time."""
        return self.jobs.busy and self.live is None

    # Computing and painting

    def compute(self, start: State | None = None) -> None:
        """A new picture for the knobs as they are now, from `start` or from where the visitor chose."""
        self.stability.moved()
        if self.session.mode == "live":
            if self.live is not None:
                self.live.change(self.session.scene)
            self.idle()
        else:
            self.jobs.submit(partial(self._settled, self.session.scene, start))

    def _settled(self, scene: Scene, start: State | None, stop: Stop) -> Iterator[Settled]:
        """Pictures on the way to the steady state; kernels that are not compiled yet are waited for."""
        self._await_live_kernels(scene, stop)
        self.session.began = start or self.session.previous_state()
        pictures = settling(scene, start=self.session.began, samples=samples_for(scene), stop=stop)
        yield next(pictures)
        if all(COMPILER.await_piece(scene, piece, stop) for piece in (CERTIFIED, CURVE)):
            for picture in pictures:
                yield picture
                if picture.final and self.session.account:
                    yield with_account(picture, stop)

    def _await_live_kernels(self, scene: Scene, stop: Stop) -> None:
        if not COMPILER.has(scene, LIVE):
            self.later(self.note, SENTENCE)
            for piece in (LIVE, CERTIFIED, CURVE):
                COMPILER.ask(scene, piece)
            COMPILER.await_piece(scene, LIVE, stop)

    def live_step(self, samples: int | None, stop: Stop) -> Iterator[LivePicture]:
        """One step of the live run: so many samples, or as many as viewing time asks for."""
        live = self.live
        if live is not None:
            self._await_live_kernels(self.session.scene, stop)
            yield live.advance(samples) if samples else live.step(self.session.speed)

    def _arrived(self, picture: Settled | LivePicture) -> None:
        live = isinstance(picture, LivePicture)
        if live != (self.session.mode == "live") or picture.run.scene.name != self.session.scene.name:
            return
        if isinstance(picture, Settled):
            self.session.picture = picture
            self.accuracy.describe()
            self.stability.arrived(picture)
        if self.session.notice:
            self.note("")
        self._painter.offer(picture)

    def shown_run(self) -> Run | None:
        """What is on the screen, as a run."""
        if self.live is not None:
            return self.live.window_run()
        return None if self.session.picture is None else self.session.picture.run

    def _send(self, number: int, picture: Settled | LivePicture) -> None:
        with in_one_go(self._document):
            if isinstance(picture, Settled):
                show_settled(self.views, number, picture)
            else:
                show_live(self.views, number, picture, self.session.playing)

    def idle(self) -> None:
        """The browser has painted everything: in live mode that asks for the next step."""
        if self.session.mode == "live" and self.session.playing and not self._painter.waits:
            self.jobs.submit(partial(self.live_step, None))

    # What the visitor does

    def _ready(self, message: dict[str, Any]) -> None:
        send_at_once(self._document)
        self.views.trains.fit(bool(message.get("narrow")))
        self.looks.choose({"value": message.get("look")})
        self._new_scene()

    def _new_scene(self) -> None:
        scene = self.session.scene
        self.views.knobs.state = knob_state(scene)
        self.views.corner.display(look_at=scene.look_at, paper=scene.paper)
        self.header()
        self._describe()
        self.curves.open(scene)
        if self.session.mode == "live":
            self.live = LiveRun(scene)
        self.compute()

    def header(self) -> None:
        session = self.session
        self.views.header.display(
            scenes=presets(), scene=session.scene.name, mode=session.mode, start=session.start, look=session.look,
            speeds=list(SPEEDS), speed=session.speed, playing=session.playing, query=session.link)

    def _describe(self) -> None:
        scene = self.session.scene
        self.observer.changed()
        self.accuracy.describe()
        self.branches.describe()
        self.effects.changed()
        self.map.moved()
        self.views.equation.display(latex=scene.equation_latex())
        self.views.corner.display(validity=list(scene.validity()))

    def _set(self, message: dict[str, Any]) -> None:
        name = str(message.get("name"))
        try:
            self.session.change(name, message.get("value"))
            self._turned(name)
        finally:
            self._echo(message.get("seq"))

    def _restore(self, message: dict[str, Any]) -> None:
        self.session.restore(str(message.get("name")))
        self._echo(message.get("seq"))
        self._turned(str(message.get("name")))

    def _echo(self, seq: object = None) -> None:
        scene = self.session.scene
        self.views.knobs.tell(type="values", seq=seq, values=dict(scene.knobs),
                              foundation=foundation_words(scene), kept=beside_kappa(scene), query=self.session.link)

    def _turned(self, name: str) -> None:
        self.compute()
        if self.session.sentence:
            self.say("")
        self._describe()
        if name != "f":
            self.curves.moved(self.session.scene)

    def switched(self, name: str, on: bool) -> None:
        """Switch an effect; the knobs follow."""
        self.session.switch(name, on)
        self._echo()
        self._turned(name)

    def turn_to(self, scene: Scene, start: State) -> None:
        """The same chain with several knobs turned at once, from a given state."""
        self.session.scene = scene
        self._echo()
        self._describe()
        self.compute(start)

    def _cover(self, message: dict[str, Any]) -> None:
        """A page over the pictures was opened or closed."""
        self.covered = message.get("name") is not None
        if message.get("name") == "accuracy":
            self.accuracy.open()

    def _choose_frequency(self, frequency: float) -> None:
        low, high = slider_range(self.session.scene, "f")
        self.session.change("f", round(min(max(frequency, low), high), 1))
        self._echo()
        self._turned("f")

    def _scene(self, message: dict[str, Any]) -> None:
        self.session.choose(message.get("name"))
        self.say("")
        self._new_scene()

    def _understood(self, _: dict[str, Any]) -> None:
        self.session.notice = ""
        self.say("")
