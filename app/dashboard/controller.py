"""The controller of one dashboard: passes browser messages to their actions, and is the host of all pages."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from bokeh.document import Document

from granchain_core import BadInput, CurvePoint, Scene, Settled, State

from ..curve.page import CurveController
from ..parts.knobs import beside_knobs, knob_state
from ..pictures.theme import Theme
from ..serve.changes import gathered
from ..serve.channel import Channel
from ..serve.compiler import COMPILER
from ..serve.document_lock import with_document_lock
from ..serve.meters import METERS
from ..serve.socket_tuning import disable_nagle
from ..session.activities import Activity, account_activity, picture_activities
from ..session.hooks import Actions, Page, all_actions
from ..session.live import LiveRun
from ..session.message_checks import quoted
from ..session.session import Session, clicked_frequency
from .addresses import take_address
from .display_choices import DisplayChoices
from .gallery import cards
from .layout import Views
from .links_and_files import LinksAndFiles
from .main_picture import Pictures
from .pinned import Pinned
from .playback import Playback
from .sentences import Sentences
from .show import show_regime
from .table import CURVE, PAGES


class Controller:
    """One visitor's dashboard: owns session, pictures and pages, and passes each message to the action of its name.

    It is the `Host` of its pages. Everything here runs with the document locked.
    """

    def __init__(self, document: Document, session: Session, start: State | None = None) -> None:
        self._document = document
        self._channel = Channel(document)
        self._left = False
        self._first_start = start
        self._origin = "rest"
        METERS.visitors += 1
        METERS.opened += 1
        self.session = session
        self.views = views = Views(session, self.received, partial(self._guarded, self._choose_frequency))
        self.sentences = Sentences(session, views.status_line, self._compute)
        self.pictures = Pictures(self, views, self.sentences.note, self._arrived)
        self.curves = CurveController(self, views.curve, views.curvebar, self._curve_placed)
        self.choices = DisplayChoices(session, views, self.curves, self._theme_changed, self._update_header,
                                      self.pictures.redraw)
        self.files = LinksAndFiles(self, views, self.curves, self.pictures)
        self.pinned = Pinned(self, views)
        self.pages = tuple(row.page(self, views.overlays.get(row.name, views.tabs)) for row in PAGES)
        self._looked_at: dict[str, Page | CurveController] = {
            CURVE: self.curves, **{row.name: page for row, page in zip(PAGES, self.pages, strict=True)}}
        own: Actions = {
            "ping": lambda _: views.chain.send(type="pong"),
            "ready": self._ready, "window-shown": lambda _: self.pictures.restart(),
            "narrow": lambda m: views.set_compact(bool(m.get("value"))),
            "visible": self._visible,
            "painted": lambda m: self.pictures.painted(m.get("number")),
            "set": self._set, "restore": self._restore, "scene": self._scene, "go": self._go,
            "gallery": lambda _: views.header.send(type="gallery", cards=cards()),
            **self.sentences.actions,
        }
        playback = Playback(session, self.pictures, self._compute, self._update_header, self.say)
        self.owners: dict[str, Actions] = {
            "the dashboard": own, "playback": playback.actions, "links and files": self.files.actions,
            "display choices": self.choices.actions, "pins": self.pinned.actions,
            **{f"page `{row.name}`": page.actions for row, page in zip(PAGES, self.pages, strict=True)},
        }
        self._actions = all_actions(self.owners)
        views.tabs.update_state(place=session.place)

    # Coming in and going out

    def received(self, message: dict[str, Any]) -> None:
        """Take a message from the browser, in which nothing is trusted."""
        name = message.get("do")
        action = self._actions.get(name) if isinstance(name, str) else None
        if action is None:
            action, message = self._unknown, {"name": quoted(name)}
        with_document_lock(self._document, partial(self._guarded, action, message))

    def _unknown(self, message: dict[str, Any]) -> None:
        self.say(f"The server does not know the request {message['name']}; reload the page.")

    def _guarded(self, action: Callable[..., None], *arguments: Any) -> None:
        if self._left:
            return
        with gathered(self._document):
            try:
                action(*arguments)
            except Exception as error:
                self.failed(error)

    def next_tick(self, action: Callable[..., None], *arguments: Any) -> None:
        """Call `action` with the document locked, as soon as that is possible; this may be called from any thread."""
        if not self._left:
            self._channel.call_soon(partial(self._guarded, action, *arguments))

    def call_later(self, seconds: float, action: Callable[..., None], *arguments: Any) -> None:
        """Call `action` with the document locked, so many seconds from now."""
        if not self._left:
            self._channel.call_later(seconds, partial(self._guarded, action, *arguments))

    def say(self, sentence: str) -> None:
        """Show the visitor one sentence until the next valid action; an empty one removes it."""
        self.sentences.say(sentence)

    def failed(self, error: Exception) -> None:
        """Say in one sentence what happened; the last good picture stays."""
        self.sentences.failed(error)

    def close(self, session_context: object) -> None:
        """The visitor left: everything that is computed for this page ends, and nothing is called any more."""
        if self._left:
            return
        self._left = True
        self._channel.close()
        METERS.visitors -= 1
        self.pictures.close()
        self.curves.close()
        self.files.close()
        self.pinned.close()
        for page in self.pages:
            page.close()

    # What the pages ask for

    @property
    def busy(self) -> bool:
        """Whether a picture is being computed."""
        return self.pictures.busy

    @property
    def awaiting_picture(self) -> bool:
        """Whether a knob has moved and its steady picture is not there yet."""
        return self.pictures.awaiting_picture

    @property
    def curve_computing(self) -> bool:
        """Whether a resonance curve is being computed."""
        return self.curves.computing

    def complete_curve(self) -> list[CurvePoint]:
        """The resonance curve from rest of the present knobs; empty unless all of it is there."""
        return self.curves.complete(self.session.scene).get("rest", [])

    def show(self, scene: Scene, state: State | None = None, mode: str = "settled") -> None:
        """Turn the knobs to `scene` and show its motion, from `state` or from where the visitor chose."""
        self.session.set_mode(mode)
        self.session.scene = scene
        if mode == "settled":
            self.pictures.live = None
        elif state is not None or self.pictures.live is None:
            self.pictures.live = LiveRun(scene, self.session.cpu_time, state)
        self._update_header()
        self._send_knob_values()
        self._scene_changed(state)

    def open(self, scene: Scene, state: State | None, curves: str) -> None:
        """Open a scene, maybe another preset, settled from `state` or from rest, with the curves of a link."""
        session = self.session
        another = scene.name != session.scene.name
        session.open(scene)
        self.pictures.live = None
        self.say("")
        if another:
            session.curves = curves or "auto"
            self._new_scene(state)
            return
        if curves:
            session.curves = self.curves.select(scene, curves)
        self._update_header()
        self._send_knob_values()
        self._scene_changed(state)

    def address_changed(self) -> None:
        """What the address of the page says has changed, but no knob has."""
        self.views.header.send(type="address", query=self.session.link)

    def activities(self) -> list[Activity]:
        """Everything that is computed for this visitor, or could be."""
        return [
            *picture_activities(self.session, self.busy), *self.curves.activities(),
            account_activity(self.session, self.busy), *(page.activity for page in self.pages if page.activity),
        ]

    def _arrived(self, picture: Settled) -> None:
        if picture.start != self._origin:
            self._origin = picture.start
            self._update_header()
        self.pinned.picture_ready(picture)
        self.files.picture_ready(picture)
        for page in self.pages:
            page.picture_ready(picture)

    def _curve_placed(self) -> None:
        show_regime(self.views)
        if self.complete_curve():
            for page in self.pages:
                page.curve_ready()

    def _theme_changed(self, theme: Theme) -> None:
        for page in self.pages:
            page.theme_changed(theme)

    # What the visitor does

    def _ready(self, message: dict[str, Any]) -> None:
        disable_nagle(self._document)
        self.views.set_compact(bool(message.get("narrow")))
        COMPILER.prepare(self.session.scene)  # not when the page is fetched: that starts no compiler
        self.choices.choose({"value": message.get("theme")})
        self.pinned.show()
        self._new_scene(self._first_start)

    def _visible(self, message: dict[str, Any]) -> None:
        name, visible = message.get("name"), message.get("value")
        one = self._looked_at.get(name) if isinstance(name, str) else None
        if one is None or not isinstance(visible, bool):
            raise BadInput(f"There is no page {quoted(name)} to look at.")
        one.visibility_changed(visible)

    def _new_scene(self, start: State | None = None) -> None:
        scene = self.session.scene
        self.views.scales.forget()
        self.views.knobs.state = knob_state(scene)
        self.views.tabs.update_state(look_at=scene.look_at, paper=scene.paper)
        self._tell_pages()
        self.session.curves = self.curves.open(scene, self.session.curves)
        self._update_header()
        if self.session.mode == "live":
            self.pictures.live = LiveRun(scene, self.session.cpu_time)
        self._compute(start)

    def _compute(self, start: State | None = None) -> None:
        for page in self.pages:
            page.picture_requested()
        self.pictures.compute(start)

    def _update_header(self) -> None:
        self.views.header.show_session(self.session, self._origin)

    def _tell_pages(self) -> None:
        scene = self.session.scene
        self.pinned.scene_changed()
        for page in self.pages:
            page.scene_changed()
        self.views.equation.update_state(latex=scene.equation_latex())
        self.views.tabs.update_state(validity=list(scene.validity()))

    def _set(self, message: dict[str, Any]) -> None:
        name = str(message.get("name"))
        try:
            self.session.change(name, message.get("value"))
            self._scene_changed()
        finally:
            self._send_knob_values(message.get("seq"))

    def _restore(self, message: dict[str, Any]) -> None:
        self.session.restore(str(message.get("name")))
        self._send_knob_values(message.get("seq"))
        self._scene_changed()

    def _send_knob_values(self, seq: object = None) -> None:
        scene = self.session.scene
        self.views.knobs.send(type="values", seq=seq, values=dict(scene.knobs), **beside_knobs(scene),
                              query=self.session.link)

    def _scene_changed(self, start: State | None = None) -> None:
        self._compute(start)
        if self.session.sentence:
            self.say("")
        self._tell_pages()
        self.curves.moved(self.session.scene)

    def _choose_frequency(self, frequency: object) -> None:
        self.session.change("f", clicked_frequency(self.session.scene, frequency))
        self._send_knob_values()
        self._scene_changed()

    def _scene(self, message: dict[str, Any]) -> None:
        self.session.choose(message.get("name"))
        self.session.curves = "auto"
        self.say("")
        self._new_scene()

    def _go(self, message: dict[str, Any]) -> None:
        """A step back or forward: the session becomes what the address says, its picture to the last digit."""
        session, name, curves = self.session, self.session.scene.name, self.session.curves
        start, refused = take_address(session, str(message.get("query", "")))
        if session.mode == "settled":
            self.pictures.live = None
        elif self.pictures.live is None:
            self.pictures.live = LiveRun(session.scene, session.cpu_time)
        for page in self.pages:
            page.address_taken()
        self.pinned.show()
        if session.scene.name != name:
            self._new_scene(start)
        else:
            if session.curves != curves:
                session.curves = self.curves.select(session.scene, session.curves)
            self._update_header()
            self._send_knob_values()
            self._scene_changed(start)
        self.say(" ".join(refused))
        self.views.header.send(type="address-applied", query=session.link)
