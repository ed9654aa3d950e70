"""The method and setting in use on the main page, and its place among the measured rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from granchain_core import Scene, Settled
from granchain_core.accuracy import Row
from granchain_core.accuracy.compared_methods import label
from granchain_core.integrate import METHODS, MethodSetting, method_for
from granchain_core.runs.live import LIVE_SETTING
from granchain_core.steady.settling.refine_orbit import orbit_setting


@dataclass(frozen=True)
class PlacedSetting:
    """A setting in words, with its error and time [s], interpolated between measured neighbours."""

    method: str
    label: str
    error: float
    wall_s: float


def shown_setting(scene: Scene, settled: Settled | None, live: bool) -> MethodSetting:
    """Return the setting of the last computation of the picture, by the rule of steady/settling/refine_orbit.py."""
    if live:
        return LIVE_SETTING
    if settled is None:
        return method_for(scene.accuracy, scene.cuts_tension)
    if settled.preview or settled.regime.name != "periodic":
        return MethodSetting(settled.run.cost.method)
    return orbit_setting(scene, scene.accuracy, settled.regime.assumed_contraction).finer()


def locate(setting: MethodSetting, rows: Sequence[Row]) -> PlacedSetting | None:
    """Return the place of `setting` on the measured line of its method; None until the line has two points."""
    value = setting.tolerance if METHODS[setting.method].error_control else float(setting.refine)
    known = sorted((row.value, row.error, row.wall_s) for row in rows
                   if row.method == setting.method and not row.failure and 0.0 < row.error < np.inf)
    if len(known) < 2:
        return None
    values, errors, seconds = np.log(np.array(known)).T
    at = np.log(value)
    return PlacedSetting(setting.method, label(setting), float(np.exp(np.interp(at, values, errors))),
                         float(np.exp(np.interp(at, values, seconds))))
