"""Results from which the figures are drawn; `rows` yields the numbers of a figure as rows of a table."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ..experiment import Feature, Measured, Series, Shaker
from ..observers import Twin
from ..orbits.unit_circle import outside
from ..results.run import Run
from ..scene import Scene
from ..steady.curve.curve import Curve
from ..steady.settling.outcome import Settled

Row = dict[str, Any]
#: Time shown of force trains [s]: six periods at 60 Hz, nine at 90 Hz, five at 50 Hz.
SHOWN = 0.1


class Result(Protocol):
    """The result of any figure."""

    def rows(self) -> Iterator[Row]:
        """Yield the figure's numbers, one dictionary per row, with units in the names."""


@dataclass(frozen=True, eq=False)
class Rig:
    """Figures 1, 4 and 8: a chain at rest, with dimensions from the scene. `fixture` adds the apparatus around it."""

    scene: Scene
    fixture: bool = False

    def rows(self) -> Iterator[Row]:
        """Yield position, radius and mass of every bead; the driver is bead 0."""
        place = 0.0
        for number, bead in enumerate((self.scene.bead(1), *self.scene.beads)):
            place += bead.radius if number == 0 else 2.0 * bead.radius
            yield {"bead": number, "centre_m": place, "radius_m": bead.radius, "mass_kg": bead.mass,
                   "foundation_N_per_m": self.scene.k if number else 0.0}


@dataclass(frozen=True, eq=False)
class Transmission:
    """Figure 2: the curve from rest, and a measured curve."""

    curve: Curve
    measured: Measured | None = None

    def rows(self) -> Iterator[Row]:
        """Yield one row per frequency, then the measured points."""
        yield from _curve_rows(self.curve)
        yield from _measured_rows(self.measured)


@dataclass(frozen=True, eq=False)
class EnergyMaps:
    """Figure 3: settled orbits, repeated for `periods` drive periods each."""

    parts: tuple[tuple[Settled, int], ...]

    def rows(self) -> Iterator[Row]:
        """Yield one row per instant: drive, force, and the kinetic energy of every bead."""
        for settled, periods in self.parts:
            index, time = repeated(settled.run, periods)
            for i, t in zip(index, time, strict=True):
                yield {"scene": settled.run.scene.name, "time_s": t,
                       "drive_displacement_m": settled.run.drive_displacement[i],
                       "input_force_N": settled.run.input_force[i],
                       **{f"kinetic_energy_{bead}_J": energy
                          for bead, energy in enumerate(settled.run.kinetic_energy[i], 1)}}


@dataclass(frozen=True, eq=False)
class ShakerAmplitude:
    """Figure 5: velocity amplitude V0 = 2πf A0 over f [Hz] for amplitudes A0 [m], and the measured amplitude."""

    frequency: np.ndarray
    amplitudes: tuple[float, ...]
    measured: Shaker | None = None

    def velocity(self, amplitude: float) -> np.ndarray:
        """Return V0 over the frequencies [m/s]."""
        return np.asarray(2.0 * math.pi * self.frequency * amplitude)

    def rows(self) -> Iterator[Row]:
        """Yield one row per frequency and amplitude, then the measured points."""
        for amplitude in self.amplitudes:
            for f, v in zip(self.frequency, self.velocity(amplitude), strict=True):
                yield {"source": "computed", "frequency_Hz": f, "velocity_m_s": v, "displacement_m": amplitude}
        if self.measured is not None:
            for f, v, a in zip(self.measured.frequency, self.measured.velocity, self.measured.displacement,
                               strict=True):
                yield {"source": "measured", "frequency_Hz": f, "velocity_m_s": v, "displacement_m": a}


@dataclass(frozen=True, eq=False)
class RigCurves:
    """Panel (a) of figures 6 and 9: the rig's curves at constant amplitudes, features stated in the text, states."""

    curves: tuple[Curve, ...]
    features: tuple[Feature, ...]
    states: tuple[tuple[float, Settled], ...] = ()
    """Motions at individual amplitudes, each with the frequency [Hz] that the paper gives it."""
    measured: Measured | None = None

    def rows(self) -> Iterator[Row]:
        """Yield the rows of every curve, then the states, then the measured points."""
        for curve in self.curves:
            for row in _curve_rows(curve):
                yield {"panel": "a", **row}
        for named, settled in self.states:
            yield {"panel": "a", "source": f"state shown at {named:g} Hz", "A0_m": settled.run.scene.A0,
                   "frequency_Hz": settled.run.scene.f,
                   "max_output_force_elastic_N": settled.run.max_output_force_elastic,
                   "regime": settled.regime.name, "period": settled.regime.period}
        for row in _measured_rows(self.measured):
            yield {"panel": "a", **row}


@dataclass(frozen=True, eq=False)
class Column:
    """One frequency of figures 6b, 7, 9b, 10 and 12: force trains over `SHOWN` seconds.

    named : the paper's frequency [Hz]. found : the settled orbit of model (5). time (T,) : from 0 [s]. velocity,
    input_force, output_force, contact (T,) : of that orbit; `contact` is whether driver and bead 1 touch. observer :
    output force of model (3) at `observer_time`, or None. measured : the user's series, shifted to be in phase.
    """

    named: float
    found: Settled
    time: np.ndarray
    velocity: np.ndarray
    input_force: np.ndarray
    output_force: np.ndarray
    contact: np.ndarray
    observer_time: np.ndarray | None = None
    observer: np.ndarray | None = None
    observer_words: str = ""
    measured: Series | None = None

    def rows(self) -> Iterator[Row]:
        """Yield the rows of model (5), then of model (3), then of the measured series."""
        for values in zip(self.time, self.velocity, self.input_force, self.output_force, self.contact, strict=True):
            yield {"frequency_in_paper_Hz": self.named, "source": "model (5)", "f_Hz": self.found.run.scene.f,
                   "A0_m": self.found.run.scene.A0,
                   **dict(zip(("time_s", "velocity_m_s", "input_force_N", "output_force_N", "contact"), values,
                              strict=True))}
        if self.observer_time is not None and self.observer is not None:
            for t, force in zip(self.observer_time, self.observer, strict=True):
                yield {"frequency_in_paper_Hz": self.named, "source": "model (3)", "time_s": t,
                       "output_force_N": force}
        if self.measured is not None:
            columns = {name: getattr(self.measured, attribute) for name, attribute in (
                ("velocity_m_s", "velocity"), ("input_force_N", "input_force"), ("output_force_N", "output_force"))}
            for i, t in enumerate(self.measured.time):
                yield {"frequency_in_paper_Hz": self.named, "source": "measured", "time_s": t,
                       **{name: values[i] for name, values in columns.items() if values is not None}}


@dataclass(frozen=True, eq=False)
class Trains:
    """Figures 7, 10 and 12: one column for each frequency."""

    columns: tuple[Column, ...]

    def rows(self) -> Iterator[Row]:
        """Yield the rows of all columns."""
        for column in self.columns:
            yield from column.rows()


@dataclass(frozen=True, eq=False)
class RigResponse:
    """Figures 6 and 9: (a) curves, (b) trains at 60 Hz."""

    curves: RigCurves
    column: Column

    def rows(self) -> Iterator[Row]:
        """Yield the rows of both panels."""
        yield from self.curves.rows()
        for row in self.column.rows():
            yield {"panel": "b", **row}


@dataclass(frozen=True, eq=False)
class CoupledRow:
    """One row of figure 11: a chain and its observer, the coupled system (4), at one frequency [Hz] and κ."""

    frequency: float
    kappa: float
    twin: Twin

    @property
    def multipliers(self) -> np.ndarray:
        """Multipliers of chain and observer, panel (a) or (d)."""
        multipliers = self.twin.multipliers
        assert multipliers is not None  # the figure's orbits are periodic
        return multipliers

    @property
    def outside(self) -> np.ndarray:
        """The multipliers outside the unit circle."""
        return self.multipliers[outside(self.multipliers, self.twin.scene.has_dissipation)]

    @property
    def first_beads(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the displacement [m] of bead 1 of chain and observer over `twin.time`, panels (b), (c) or (e), (f)."""
        return self.twin.chain[:, 0], self.twin.observer[:, 0]


@dataclass(frozen=True, eq=False)
class Observers:
    """Figure 11: multipliers of model (4) and the first beads of both chains, without and with foundation."""

    parts: tuple[CoupledRow, ...]

    def rows(self) -> Iterator[Row]:
        """Yield the multipliers, then both first beads over time."""
        for part in self.parts:
            orbit = part.twin.orbit
            assert orbit is not None and orbit.observer_multipliers is not None
            for whose, multipliers in (("chain", orbit.multipliers), ("observer", orbit.observer_multipliers)):
                for mu in multipliers:
                    yield {"kappa": part.kappa, "f_Hz": part.frequency, "multiplier_of": whose, "real": mu.real,
                           "imaginary": mu.imag, "modulus": abs(mu)}
        for part in self.parts:
            chain, observer = part.first_beads
            for t, x, y in zip(part.twin.time, chain, observer, strict=True):
                yield {"kappa": part.kappa, "f_Hz": part.frequency, "time_s": t, "chain_bead_1_m": x,
                       "observer_bead_1_m": y}


def repeated(run: Run, periods: float) -> tuple[np.ndarray, np.ndarray]:
    """Return indices that repeat a recorded orbit for `periods` drive periods, and their times from 0 [s].

    A motion that does not repeat is shown once, for as long as it was recorded.
    """
    rows = len(run.time) - 1
    count = round(periods * run.samples) + 1
    if run.regime.name != "periodic":
        count = min(count, rows + 1)
        return np.arange(count), np.arange(count) / (run.samples * run.scene.f)
    return np.arange(count) % rows, np.arange(count) / (run.samples * run.scene.f)


def _curve_rows(curve: Curve) -> Iterator[Row]:
    for p in curve.points:
        yield {"source": "computed", "A0_m": curve.scene.A0, "frequency_Hz": p.frequency,
               "max_output_force_elastic_N": p.max_output_force_elastic, "max_output_force_N": p.max_output_force,
               "max_input_force_N": p.max_input_force, "relative_error_elastic": p.force_errors.elastic,
               "regime": p.regime.name, "period": p.regime.period}


def _measured_rows(measured: Measured | None) -> Iterator[Row]:
    if measured is not None:
        errors = measured.error if measured.error is not None else [None] * len(measured.frequency)
        for f, force, error in zip(measured.frequency, measured.force, errors, strict=True):
            yield {"source": "measured", "frequency_Hz": f, "measured_force_N": force, "measured_error_N": error}
