"""The Effects panel of one visitor: switches, the kernel's slots, what each effect costs, what is being computed."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from granchain_core import BadInput, Cancelled, Scene
from granchain_core.accuracy.compiled import ACCOUNT_PIECE, COST_PIECE
from granchain_core.accuracy.effect_cost import CODE, MOTION, EffectCost, Variant, effect_cost
from granchain_core.integrate.engine import new_stop
from granchain_core.warm import structure

from ...cli.explain import slots_of
from ...page.job_list import activities
from ...serve.compiler import CERTIFIED, COMPILER, CURVE, LIVE
from ...serve.queues import MEASUREMENTS, Stop
from .switches import EFFECTS, present, refusal, variants

if TYPE_CHECKING:
    from ...page.controller import Controller

_REFRESH = 400
"""Milliseconds between looks at what is going on, while the panel is on the screen."""
_QUIET = 0.7
"""Seconds without a movement of a knob before anything is measured."""
_PATIENCE = 0.005


class EffectsPanel:
    """While it is on the screen it looks at the jobs, and has the cost of one effect after the other measured."""

    def __init__(self, page: Controller) -> None:
        self._page = page
        self._stop: Stop = new_stop()
        self._open = False
        self._turn = 0
        self._moved = 0.0
        self._key: tuple[object, ...] = ()
        self._costs: dict[str, dict[str, EffectCost]] = {}
        self._failed: dict[str, str] = {}
        self._compiling = ""
        self.measuring = ""
        self.actions: dict[str, Callable[[dict[str, Any]], None]] = {
            "effects-visible": self._visible, "switch": self._switch,
        }

    @property
    def progress_words(self) -> str:
        """How far the measuring of costs is."""
        if self._compiling:
            return f"compiling a kernel for {EFFECTS[self._compiling].title}"
        if self.measuring:
            return f"timing {EFFECTS[self.measuring].title}"
        possible = sum(variants(name, self._page.session.scene) is not None for name in EFFECTS)
        return f"{len(self._costs)} of {possible} effects measured"

    def changed(self) -> None:
        """A knob has moved: nothing is measured for a while, and what belongs to another kernel is forgotten."""
        self._moved = time.monotonic()
        scene = self._page.session.scene
        key = (structure(scene), scene.knobs["N"])
        if key != self._key:
            self._key = key
            self._stop[0] = 1
            self._costs, self._failed, self._compiling, self.measuring = {}, {}, "", ""
        if self._open:
            self._show()

    def close(self) -> None:
        """The visitor left."""
        self._open = False
        self._stop[0] = 1

    def _visible(self, message: dict[str, Any]) -> None:
        self._open = bool(message.get("value"))
        self._turn += 1
        if self._open:
            self._look(self._turn)

    def _switch(self, message: dict[str, Any]) -> None:
        name, on = message.get("name"), message.get("value")
        if not isinstance(name, str) or name not in EFFECTS or not isinstance(on, bool):
            raise BadInput(f"There is no effect {str(name)[:40]!r} to switch.")
        try:
            self._page.switched(name, on)
        finally:
            self._show()

    def _look(self, turn: int) -> None:
        """Again and again while the panel is open."""
        if not self._open or turn != self._turn:
            return
        self._next()
        self._show()
        self._page.after(_REFRESH, self._look, turn)

    def _next(self) -> None:
        """Begin what is to be done next: compile for one effect, or time it."""
        scene = self._page.session.scene
        busy = self.measuring or self._page.unsettled or self._page.curves.computing
        if busy or time.monotonic() - self._moved < _QUIET:
            return
        if not COMPILER.has(scene, LIVE, CERTIFIED, CURVE):  # the picture's own kernels come first
            return
        self._compiling = ""
        for name in EFFECTS:
            pair = variants(name, scene)
            if name in self._costs or name in self._failed or pair is None:
                continue
            if self._compiled(name, pair):
                self._measure(name, pair)
            return

    def _compiled(self, name: str, pair: tuple[Variant, Variant]) -> bool:
        """Whether both kernels only need to be loaded; one that is not there is compiled in another process."""
        for variant in pair:
            piece = ACCOUNT_PIECE if variant.balance else COST_PIECE
            if COMPILER.has(variant.scene, piece):
                continue
            self._compiling = name
            compilation = COMPILER.ask(variant.scene, piece)
            if compilation.done() and compilation.exception() is not None:
                self._failed[name] = "its kernel could not be compiled"
            return False
        return True

    def _measure(self, name: str, pair: tuple[Variant, Variant]) -> None:
        self.measuring = name
        self._stop = stop = new_stop()
        MEASUREMENTS.submit(self._work, name, pair, stop)

    def _work(self, name: str, pair: tuple[Variant, Variant], stop: Stop) -> None:
        """In the measuring thread; a moving knob holds it up."""
        try:
            for method in (CODE, MOTION):
                cost = effect_cost(*pair, method, stop, lambda: self._pause(stop))
                self._page.later(self._measured, name, method, cost, stop)
        except Cancelled:
            return
        except Exception as error:
            self._page.later(self._not_measured, name, error, stop)

    def _pause(self, stop: Stop) -> None:
        while self._page.unsettled and not stop[0]:
            time.sleep(_PATIENCE)

    def _measured(self, name: str, method: str, cost: EffectCost, stop: Stop) -> None:
        if stop[0]:
            return
        self._costs.setdefault(name, {})[method] = cost
        if method == MOTION:
            self.measuring = ""
        self._show()

    def _not_measured(self, name: str, error: Exception, stop: Stop) -> None:
        if not stop[0]:
            self._failed[name], self.measuring = str(error)[:120], ""

    def _show(self) -> None:
        session = self._page.session
        self._page.views.corner.display(panel={
            "effects": [self._effect(name, session.scene) for name in EFFECTS],
            "slots": [{"slot": name, "title": title, "type": kind}
                      for name, title, kind in slots_of(session.scene, session.account)],
            "structure": structure(session.scene),
            "step": self._step(session.scene),
            "activities": [{"name": n, "state": s, "detail": d} for n, s, d in activities(self._page)],
        })

    def _effect(self, name: str, scene: Scene) -> dict[str, Any]:
        effect, costs = EFFECTS[name], self._costs.get(name, {})
        refused = refusal(name, scene)
        return {
            "name": name, "title": effect.title, "meaning": effect.meaning, "refused": refused,
            "on": present(name, scene, self._page.session.account),
            "code": _words(costs.get(CODE)), "motion": _words(costs.get(MOTION)),
            "state": refused or self._failed.get(name) or (
                "compiling its kernel …" if name == self._compiling else
                "being timed …" if name == self.measuring else
                "not measured yet, waits for the curve" if self._page.curves.computing else "not measured yet"),
        }

    def _step(self, scene: Scene) -> dict[str, float]:
        """Nanoseconds a step of this very kernel, by method, from the last effect that was timed."""
        found: dict[str, float] = {}
        for name, costs in self._costs.items():
            on = present(name, scene, account=False)
            found.update({method: cost.with_it if on else cost.without for method, cost in costs.items()})
        return found


def _words(cost: EffectCost | None) -> dict[str, Any] | None:
    """A measured cost for the page; None where there is none."""
    if cost is None:
        return None
    return {"with": cost.with_it, "without": cost.without, "difference": cost.difference, "percent": cost.percent,
            "spread": cost.spread}
