"""The figures of Zhang et al. (2016): `paper_figure` draws any result; each type of result has its module."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bokeh.models import LayoutDOM

from granchain_core.paper import (
    EnergyMaps,
    Observers,
    Result,
    Rig,
    RigResponse,
    ShakerAmplitude,
    Trains,
    Transmission,
)

from ..theme import Theme
from .energy import energy
from .observers import observers
from .response import response
from .rig import rig
from .shaker import shaker
from .trains import trains
from .transmission import transmission

_DRAW: dict[type, Callable[[Any, Theme], LayoutDOM]] = {
    Rig: rig, Transmission: transmission, EnergyMaps: energy, ShakerAmplitude: shaker, RigResponse: response,
    Trains: trains, Observers: observers,
}
#: Width and height of a figure without its caption [px].
_SIZES = {Rig: (1100, 400), Transmission: (1100, 560), EnergyMaps: (1100, 560), ShakerAmplitude: (1100, 420),
          RigResponse: (1200, 620), Trains: (1200, 640), Observers: (1200, 640)}


def paper_figure(result: Result, theme: Theme) -> LayoutDOM:
    """Draw the figure of a result of `granchain_core.paper.compute`; it fills the available room."""
    return _DRAW[type(result)](result, theme)


def size_of(result: Result) -> tuple[int, int]:
    """Return the width and height in which a figure is easy to read [px]."""
    return _SIZES[type(result)]
