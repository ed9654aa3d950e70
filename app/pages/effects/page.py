"""The Effects tab of one session: switches, the cost of each effect, and the list of running computations."""

from __future__ import annotations

from functools import partial
from typing import Any

from granchain_core import Scene
from granchain_core.accuracy.effect_cost import CODE, MOTION, EffectCost, Variant, effect_cost
from granchain_core.integrate.scaling import slots_of
from granchain_core.precompile.pieces import COST_ACCOUNT_KERNELS, COST_KERNELS
from granchain_core.precompile.warm import structure
from granchain_core.scene.effects import ALWAYS

from ...parts.toolkit.component import Component
from ...serve.compiling.compiler import COMPILER, PICTURE_PIECES, Requests
from ...serve.computing.worker_pools import MEASUREMENTS
from ...session.activities import Activity
from ...session.debounce import Debounce
from ...session.host import PageHost
from ...session.message_checks import check_bool, check_choice
from ...session.page import Actions, Page
from ...session.progress import UNDER_WAY, activity_state
from ...session.switches import SWITCHES, present, refusal, variants
from ...session.task import Job, Task

#: Interval at which the running computations are listed while the page is visible [s].
_LIST_EVERY = 0.4
#: Time for which the knobs must rest before the cost of an effect is measured [s].
_QUIET = 0.7


class EffectsPage(Page):
    """The page, which lists running computations and measures one effect's cost after another while it is visible."""

    def __init__(self, host: PageHost, view: Component) -> None:
        self._host = host
        self._view = view
        self._task = Task(host, MEASUREMENTS, self._ended, "The cost measurement",
                          outlives_knobs="the cost of an effect does not depend on the knobs' values")
        self._visible = False
        self._round = 0
        self._quiet = Debounce(host, _QUIET)
        self._key: tuple[object, ...] = ()
        self._costs: dict[str, dict[str, EffectCost]] = {}
        self._failed: dict[str, str] = {}
        self._compiling = ""
        self._kernels = Requests(COMPILER)
        self.measuring = ""
        self.actions: Actions = {"switch": self._switch}

    @property
    def activity(self) -> Activity:
        """Name, state and detail for the list of running computations."""
        return "cost of effects", activity_state(bool(self.measuring)), self._progress_words

    @property
    def _progress_words(self) -> str:
        if self._compiling:
            return f"compiling a kernel for {SWITCHES[self._compiling].title}"
        if self.measuring:
            return f"measuring {SWITCHES[self.measuring].title}"
        possible = sum(variants(name, self._host.session.scene) is not None for name in SWITCHES)
        return f"{len(self._costs)} of {possible} effects measured"

    def scene_changed(self) -> None:
        """Pause the measurements, because a knob has moved, and forget the costs if the kernel has changed."""
        self._quiet.start(self._next)
        scene = self._host.session.scene
        key = (structure(scene), scene.knobs["N"])
        if key != self._key:
            self._key = key
            self._task.cancel()
            self._costs, self._failed, self._compiling, self.measuring = {}, {}, "", ""
        if self._visible:
            self._show()

    def visibility_changed(self, visible: bool) -> None:
        """List the running computations, and measure, while the page is visible."""
        self._visible = visible
        self._round += 1
        if visible:
            self._poll(self._round)

    def _switch(self, message: dict[str, Any]) -> None:
        name = check_choice("effect", message.get("name"), SWITCHES)
        on = check_bool(name, message.get("value"))
        try:
            session = self._host.session
            session.switch(name, on)
            self._host.turn_knobs(session.scene, mode=session.mode)
        finally:
            self._show()

    def _poll(self, number: int) -> None:
        """Start the next measurement and show everything, repeatedly while the panel is open."""
        if not self._visible or number != self._round:
            return
        self._next()
        self._show()
        self._host.call_later(_LIST_EVERY, self._poll, number)

    def _next(self) -> None:
        """Start the next task: compile the kernels of an effect, or measure its cost."""
        scene = self._host.session.scene
        busy = self.measuring or self._host.awaiting_picture or self._host.curve_computing
        if busy or self._quiet.pending or not self._visible:
            return
        if not COMPILER.has(scene, *PICTURE_PIECES):  # the picture's own kernels come first
            return
        self._compiling = ""
        for name in SWITCHES:
            pair = variants(name, scene)
            if name in self._costs or name in self._failed or pair is None:
                continue
            if self._compiled(name, pair):
                self._measure(name, pair)
            return

    def _compiled(self, name: str, pair: tuple[Variant, Variant]) -> bool:
        """Return whether both kernels are compiled; if one is not, another process starts to compile it."""
        for variant in pair:
            piece = COST_ACCOUNT_KERNELS if variant.account else COST_KERNELS
            if COMPILER.has(variant.scene, piece):
                continue
            if self._kernels.failure(variant.scene, piece) is None:
                self._compiling = name
            else:
                self._failed[name] = "its kernel could not be compiled"
            return False
        return True

    def _measure(self, name: str, pair: tuple[Variant, Variant]) -> None:
        self.measuring = name
        self._task.start(partial(self._work, name, pair))

    def _work(self, name: str, pair: tuple[Variant, Variant], job: Job) -> None:
        """In the measuring thread, measure both costs, waiting while a knob moves."""
        for method in (CODE, MOTION):
            cost = effect_cost(*pair, method, job.stop, job.give_way)
            job.next_tick(self._measured, name, method, cost)

    def _measured(self, name: str, method: str, cost: EffectCost) -> None:
        self._costs.setdefault(name, {})[method] = cost
        self._show()

    def _ended(self, status: str, sentence: str) -> None:
        if status == "failed":
            self._failed[self.measuring] = sentence[:120]
        self.measuring = ""
        self._show()

    def _show(self) -> None:
        session = self._host.session
        self._view.update_state(panel={
            "effects": [self._effect(name, session.scene) for name in SWITCHES],
            "slots": [{"slot": name, "title": title, "type": kind}
                      for name, title, kind in slots_of(session.scene, session.energy_account)],
            "always": list(ALWAYS),
            "structure": structure(session.scene),
            "step": self._step(session.scene),
            "activities": [{"name": n, "state": s, "detail": d} for n, s, d in self._host.activities()],
        })

    def _effect(self, name: str, scene: Scene) -> dict[str, Any]:
        effect, costs = SWITCHES[name], self._costs.get(name, {})
        refused = refusal(name, scene)
        return {
            "name": name, "slot": effect.slot, "title": effect.title, "meaning": effect.meaning, "refused": refused,
            "on": present(name, scene, self._host.session.energy_account),
            "code": _words(costs.get(CODE)), "motion": _words(costs.get(MOTION)),
            "state": refused or self._failed.get(name) or (
                "compiling its kernel …" if name == self._compiling else
                UNDER_WAY["measuring"] if name == self.measuring else
                "not measured yet, waits for the curve" if self._host.curve_computing else "not measured yet"),
        }

    def _step(self, scene: Scene) -> dict[str, float]:
        """Return the time of a step of the present kernel [ns], by method, from the last effect that was measured."""
        times: dict[str, float] = {}
        for name, costs in self._costs.items():
            on = present(name, scene, account=False)
            times.update({method: cost.with_it if on else cost.without for method, cost in costs.items()})
        return times


def _words(cost: EffectCost | None) -> dict[str, Any] | None:
    """Return a measured cost for the page; None if there is none."""
    if cost is None:
        return None
    return {"with": cost.with_it, "without": cost.without, "difference": cost.difference, "percent": cost.percent,
            "spread": cost.spread}
