"""Changes of the scene and its knobs, by the visitor, a page or an address, and their consequences."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from granchain_core import Scene, Settled, State

from ..curve.controller import CurveController
from ..parts.knobs.knobs import beside_knobs, knob_state
from ..session.page import Actions, Page
from ..session.scene_facts import clicked_frequency
from ..session.session import Session
from .addresses import apply_address
from .layout import Views
from .main_picture import MainPicture
from .pinned import Pinned


class SceneChanges:
    """Sets the knobs of one session, opens scenes, and notifies pages and parts of the dashboard."""

    def __init__(self, session: Session, views: Views, pictures: MainPicture, curves: CurveController, pinned: Pinned,
                 pages: Sequence[Page], show_sentence: Callable[[str], None],
                 next_tick: Callable[[Callable[[], None]], None]) -> None:
        self._session = session
        self._views = views
        self._pictures = pictures
        self._curves = curves
        self._pinned = pinned
        self._pages = pages
        self._show_sentence = show_sentence
        self._next_tick = next_tick
        #: A settled picture that the pages have not been notified of yet.
        self._picture_for_pages: Settled | None = None
        self.actions: Actions = {"set": self._set, "restore": self._restore, "scene": self._scene, "go": self._go}

    def turn_knobs(self, scene: Scene, state: State | None, mode: str) -> None:
        """Turn the knobs to those of `scene`; see `PageHost.turn_knobs`."""
        self._session.set_mode(mode)
        self._session.scene = scene
        self._follow_mode(state)
        self._show_turned_knobs(state)

    def open_scene(self, scene: Scene, state: State | None, curves: str) -> None:
        """Open a scene, possibly another preset; see `PageHost.open_scene`."""
        session = self._session
        another = scene.name != session.scene.name
        session.open(scene)
        self._pictures.end_live()
        self._show_sentence("")
        if another:
            self.show_preset(state, curves)
            return
        if curves:
            session.curves = self._curves.select(scene, curves)
        self._show_turned_knobs(state)

    def show_preset(self, initial_state: State | None, curves: str) -> None:
        """Show the session's scene, another preset, in the whole dashboard; its motion begins in `initial_state`.

        `curves` is the field of a link; if it is empty, the same curves stay selected.
        """
        scene = self._session.scene
        self._views.scales.forget()
        self._views.knobs.state = knob_state(scene)
        self._views.tabs.update_state(look_at=scene.look_at, paper=scene.paper)
        self._notify_of_scene()
        self._session.curves = self._curves.show_preset(scene, curves)
        self._views.header.show_session(self._session)
        if self._session.mode == "live":
            self._pictures.begin_live()
        self.request_picture(initial_state)

    def choose_frequency(self, frequency: object) -> None:
        """Set the knob f to a frequency clicked on the curve."""
        self._turn(lambda: self._session.change("f", clicked_frequency(self._session.scene, frequency)))

    def request_picture(self, initial_state: State | None = None) -> None:
        """Request a picture of the present knobs."""
        self._picture_for_pages = None
        for page in self._pages:
            page.picture_requested()
        self._pictures.compute(initial_state)

    def picture_ready(self, settled: Settled) -> None:
        """Notify the pages once a picture is offered to the browser, unless another has been requested by then."""
        self._picture_for_pages = settled
        self._next_tick(self._notify_of_picture)

    def _notify_of_picture(self) -> None:
        settled, self._picture_for_pages = self._picture_for_pages, None
        if settled is not None:
            for page in self._pages:
                page.picture_ready(settled)

    # Actions of the visitor

    def _set(self, message: dict[str, Any]) -> None:
        self._turn(partial(self._session.change, str(message.get("name")), message.get("value")), message.get("seq"))

    def _restore(self, message: dict[str, Any]) -> None:
        self._turn(partial(self._session.restore, str(message.get("name"))), message.get("seq"))

    def _scene(self, message: dict[str, Any]) -> None:
        self._session.choose(message.get("name"))
        self._show_sentence("")
        self.show_preset(None, "")

    def _go(self, message: dict[str, Any]) -> None:
        """Restore the session, with exactly the same picture, from the address of a step back or forward.

        The browser is always notified. Until then, it counts every change as a part of the step (`Steps.returning` in
        address.js), and the visitor could undo no further change.
        """
        try:
            self._apply(str(message.get("query", "")))
        finally:
            self._views.header.send(type="address-applied", query=self._session.link)

    def _apply(self, query: str) -> None:
        """Set the session from an address, and show it."""
        session, name, curves = self._session, self._session.scene.name, self._session.curves
        initial_state, refused = apply_address(session, query)
        self._follow_mode()
        for page in self._pages:
            page.address_applied()
        self._pinned.show()
        if session.scene.name != name:
            self.show_preset(initial_state, session.curves)
        else:
            if session.curves != curves:
                session.curves = self._curves.select(session.scene, session.curves)
            self._show_turned_knobs(initial_state)
        self._show_sentence(" ".join(refused))

    # Consequences

    def _turn(self, change: Callable[[], None], seq: object = None) -> None:
        """Change a knob, follow it, and send the values.

        They are sent even if the change is refused, because the browser shows the refused value until it gets them.
        """
        try:
            change()
            self._follow_knobs()
        finally:
            self._send_knob_values(seq)

    def _follow_mode(self, state: State | None = None) -> None:
        """Begin a live run in live mode if there is none or it must begin in `state`; end it in settled mode."""
        if self._session.mode == "settled":
            self._pictures.end_live()
        elif state is not None or self._pictures.live is None:
            self._pictures.begin_live(state)

    def _show_turned_knobs(self, initial_state: State | None) -> None:
        """Show the new values in header and knobs, because something other than the visitor has set them."""
        self._views.header.show_session(self._session)
        self._send_knob_values()
        self._follow_knobs(initial_state)

    def _follow_knobs(self, initial_state: State | None = None) -> None:
        """Request a picture for the new knobs, then notify the pages and the curve."""
        self.request_picture(initial_state)
        if self._session.sentence:
            self._show_sentence("")
        self._notify_of_scene()
        self._curves.knob_moved(self._session.scene)

    def _notify_of_scene(self) -> None:
        """Notify pins, pages, equation and tabs of the session's scene."""
        scene = self._session.scene
        self._pinned.scene_changed()
        for page in self._pages:
            page.scene_changed()
        self._views.equation.update_state(latex=scene.equation_latex())
        self._views.tabs.update_state(validity=list(scene.validity()))

    def _send_knob_values(self, seq: object = None) -> None:
        scene = self._session.scene
        self._views.knobs.send(type="values", seq=seq, values=dict(scene.knobs), **beside_knobs(scene),
                               query=self._session.link)
