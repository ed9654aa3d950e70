"""The figures of Zhang et al. 2016 computed from the presets, and the paper's statements with granchain's numbers."""

from .figures import FIGURES, PaperFigure, compute, figure_of
from .given import Given, read_given
from .numbers import numbers_of
from .results import (
    Column,
    CoupledRow,
    EnergyMaps,
    Observers,
    Result,
    Rig,
    RigCurves,
    RigResponse,
    ShakerAmplitude,
    Trains,
    Transmission,
)
from .statements import Statement, statements

__all__ = [
    "FIGURES", "Column", "CoupledRow", "EnergyMaps", "Given", "Observers", "PaperFigure", "Result", "Rig", "RigCurves",
    "RigResponse", "ShakerAmplitude", "Statement", "Trains", "Transmission", "compute", "figure_of", "numbers_of",
    "read_given", "statements",
]
