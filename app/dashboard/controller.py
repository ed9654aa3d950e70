"""The controller of one dashboard, which is also the host of its pages.

It makes the parts of the dashboard and passes browser messages to their actions.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from bokeh.document import Document

from granchain_core import CurvePoint, Scene, Settled, State
from granchain_core.experiment import Difference, Measured

from ..curve.controller import CurveController
from ..plots.theme import THEMES, Theme
from ..serve.compiling.compiler import COMPILER
from ..serve.connection.socket_tuning import disable_nagle
from ..session.activities import Activity, account_activity, picture_activities
from ..session.message_checks import check_bool, check_choice, quoted
from ..session.page import Actions, Page, all_actions
from ..session.page_constants import CURVE_NAME
from ..session.session import Session
from .calls import Calls
from .display_choices import DisplayChoices
from .exports import Exports
from .gallery import cards
from .layout import Views
from .main_picture import MainPicture
from .pinned import Pinned
from .playback import Playback
from .scene_changes import SceneChanges
from .sentences import Sentences
from .table import PAGES, overlay_names

if TYPE_CHECKING:
    from granchain_core.fitting.overlay import Overlay


class Controller:
    """The dashboard of one session, and the `PageHost` of its pages.

    Everything runs with the document locked, except `next_tick` and the flags `busy`, `awaiting_picture` and
    `curve_computing`, which any thread may read.
    """

    def __init__(self, document: Document, session: Session, initial_state: State | None = None,
                 make_calls: Callable[[Document, Callable[[Exception], None]], Calls] = Calls) -> None:
        """Make views, parts and pages, connect them, and collect their actions.

        They are made in this order because each takes some of those before it: calls, views, sentences, the main
        picture, the curve, choices, exports, pins, pages, the scene's changes.
        The motion of the first picture begins in `initial_state` if one is given. `make_calls` makes the `Calls`; tests
        pass another one.
        """
        self._document = document
        self._calls = make_calls(document, self.show_failure)
        self._initial_state = initial_state
        self._gallery_sent = False
        self.session = session
        self.views = views = Views(session, self.receive, partial(self._calls.call_and_report, self._choose_frequency))
        self.sentences = Sentences(session, views.status_line, self._compute)
        self.pictures = MainPicture(self, views, self.sentences.show_notice, self.picture_ready)
        self.curves = CurveController(self, views.curve, views.curve_bar, self._curve_placed)
        self.choices = DisplayChoices(session, views, self.curves, self._theme_changed, self.pictures.redraw)
        self.exports = Exports(self, views, self.curves, self.pictures)
        self.pinned = Pinned(self, views)
        self.pages = tuple(row.page(self, views.overlays.get(row.name, views.tabs)) for row in PAGES)
        self.curves.on_compared(self._curve_compared)
        self._scenes = SceneChanges(session, views, self.pictures, self.curves, self.pinned, self.pages,
                                    self.show_sentence, self.next_tick)
        self._looked_at: dict[str, Page | CurveController] = {
            CURVE_NAME: self.curves, **{row.name: page for row, page in zip(PAGES, self.pages, strict=True)}}
        own: Actions = {
            "ping": lambda _: views.chain.send(type="pong"),
            "ready": self._ready, "window-shown": lambda _: self.pictures.restart(),
            "compact": lambda m: views.set_compact(check_bool("compact", m.get("value"))),
            "visible": self._visibility_reported,
            "painted": lambda m: self.pictures.painted(m.get("number"), m.get("took")),
            **self._scenes.actions,
            "gallery": self._send_gallery,
            **self.sentences.actions,
        }
        playback = Playback(session, views.header, self.pictures, self._compute, self.show_sentence)
        self.owners: dict[str, Actions] = {
            "the dashboard": own, "playback": playback.actions, "links and exports": self.exports.actions,
            "display choices": self.choices.actions, "pins": self.pinned.actions,
            **{f"page `{row.name}`": page.actions for row, page in zip(PAGES, self.pages, strict=True)},
        }
        self._actions = all_actions(self.owners)
        views.tabs.update_state(place=session.place)

    # Messages

    def receive(self, message: dict[str, Any]) -> None:
        """Pass a message from the browser to its action, which must check every value in it."""
        name = message.get("do")
        action = self._actions.get(name) if isinstance(name, str) else None
        if action is None:
            action, message = self._unknown, {"name": quoted(name)}
        self._calls.run_when_locked(self._act, str(name), action, message)

    def _act(self, name: str, action: Callable[[dict[str, Any]], None], message: dict[str, Any]) -> None:
        self.sentences.action_begins(name)
        action(message)

    def _unknown(self, message: dict[str, Any]) -> None:
        self.show_sentence(f"The server does not know the request {message['name']}; reload the page.")

    def _ready(self, message: dict[str, Any]) -> None:
        compact = check_bool("compact", message.get("compact"))
        theme = check_choice("theme", message.get("theme"), THEMES)
        disable_nagle(self._document)
        self.views.set_compact(compact)
        # Here rather than in `entry.open_web_page`: a plain GET must not start a compiler (docs/security.md).
        COMPILER.prepare(self.session.scene)
        self.choices.set_theme(theme)
        self.pinned.show()
        self._scenes.show_preset(self._initial_state, self.session.curves)

    def _visibility_reported(self, message: dict[str, Any]) -> None:
        name = check_choice("page", message.get("name"), self._looked_at)
        self._looked_at[name].visibility_changed(check_bool(f"visible {name}", message.get("value")))

    def _send_gallery(self, _: dict[str, Any]) -> None:
        """Send the cards only once: the page keeps them, and no other short message has such a large answer."""
        if not self._gallery_sent:
            self._gallery_sent = True
            self.views.header.send(type="gallery", cards=cards())

    # The methods of `PageHost`

    def next_tick(self, action: Callable[..., None], *args: Any) -> None:
        """See `PageHost`."""
        self._calls.next_tick(action, *args)

    def call_later(self, seconds: float, action: Callable[..., None], *args: Any) -> None:
        """See `PageHost`."""
        self._calls.call_later(seconds, action, *args)

    def on_close(self, action: Callable[[], object]) -> None:
        """See `PageHost`."""
        self._calls.on_close(action)

    def show_sentence(self, sentence: str) -> None:
        """Show the visitor a message; an empty text removes it. `Sentences` says how long it stays."""
        self.sentences.show_sentence(sentence)

    def show_failure(self, error: Exception) -> None:
        """See `PageHost`."""
        self.sentences.show_failure(error)

    def report_fault(self, error: Exception, sentence: str, fault: str = "") -> None:
        """See `PageHost`."""
        self.sentences.report_fault(error, sentence, fault)

    def log_failed_computation(self, error: Exception, fault: str) -> None:
        """See `PageHost`."""
        self.sentences.log_failed_computation(error, fault)

    def session_dropped(self, session_context: object) -> None:
        """Close the dashboard, because Bokeh has dropped the session."""
        self.close()

    def close(self) -> None:
        """End all computations of this session and call no further action, because it has ended."""
        self._calls.close()

    @property
    def busy(self) -> bool:
        """See `PageHost`."""
        return self.pictures.busy

    @property
    def awaiting_picture(self) -> bool:
        """See `PageHost`."""
        return self.pictures.awaiting_picture

    @property
    def overlays(self) -> tuple[str, ...]:
        """See `PageHost`."""
        return overlay_names()

    @property
    def curve_computing(self) -> bool:
        """See `PageHost`."""
        return self.curves.computing

    def complete_curve(self) -> list[CurvePoint]:
        """See `PageHost`."""
        return self.curves.complete(self.session.scene).get("rest", [])

    def show_measured_curve(self, measured: Measured | None) -> Difference | None:
        """See `PageHost`."""
        return self.curves.measured(measured)

    def show_measured_series(self, overlay: Overlay | None) -> None:
        """See `PageHost`."""
        self.views.trains.measured(overlay)

    def turn_knobs(self, scene: Scene, state: State | None = None, mode: str = "settled") -> None:
        """See `PageHost`."""
        self._scenes.turn_knobs(scene, state, mode)

    def open_scene(self, scene: Scene, state: State | None, curves: str) -> None:
        """See `PageHost`."""
        self._scenes.open_scene(scene, state, curves)

    def address_changed(self) -> None:
        """See `PageHost`."""
        self.views.header.send(type="address", query=self.session.link)

    def activities(self) -> list[Activity]:
        """See `PageHost`."""
        return [
            *picture_activities(self.session, self.busy), *self.curves.activities(),
            account_activity(self.session, self.busy), *(page.activity for page in self.pages if page.activity),
        ]

    # Events of the parts

    def picture_ready(self, settled: Settled) -> None:
        """Notify header and pins of a settled picture now, and the pages once it has been offered to the browser."""
        self.views.header.show_picture_start(settled.start, self.session)
        self.pinned.picture_ready(settled)
        self._scenes.picture_ready(settled)

    def _curve_placed(self) -> None:
        self.pictures.show_regime()
        if self.complete_curve():
            for page in self.pages:
                page.curve_ready()

    def _curve_compared(self, difference: Difference | None) -> None:
        for page in self.pages:
            page.curve_compared(difference)

    def _theme_changed(self, theme: Theme) -> None:
        for page in self.pages:
            page.theme_changed(theme)

    def _compute(self) -> None:
        """Compute a picture because of an action of the visitor; a refusal of the last one no longer applies."""
        if self.session.sentence:
            self.show_sentence("")
        self._scenes.request_picture()

    def _choose_frequency(self, frequency: object) -> None:
        self._scenes.choose_frequency(frequency)
