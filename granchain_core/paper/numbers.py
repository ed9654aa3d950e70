"""Computation of the bold numbers in the table of docs/paper.md, row by row."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..attractor_search import attractors
from ..inputs.checks import unknown_name
from ..integrate.scaling import scaled_damping, scales_of
from ..orbits import periodic_orbit
from ..results.regime import Regime
from ..scene import scene
from ..scene.state import rest
from ..steady.curve.curve import Curve
from ..steady.curve.resonance import pushes
from ..steady.curve.resonance_curve import resonance_curve
from ..steady.settling.outcome import Settled
from ..steady.settling.settle import settle
from .computations import KAPPA, MODEL_AMPLITUDES, RIG_AMPLITUDE, SECTION_2_FREQUENCIES, STATES, observers
from .peaks_and_valleys import dips, peaks

Numbers = list[float | str]
#: Density of the rig's beads [kg/m³], from the text.
_DENSITY = 7850.0
#: Samples per period that give the largest kinetic energy to 1e-8; with 96, as in many pictures, 4 % of it is missed.
_FINE = 3840


@functools.cache
def _settle(name: str, **changes: float) -> Settled:
    return settle(scene(name).evolve(**changes))


@functools.cache
def _section_2() -> Curve:
    return resonance_curve(scene("sec2"), SECTION_2_FREQUENCIES)


def _words(regime: Regime) -> str:
    return f"period {regime.period}" if regime.period else regime.name


def _elastic(name: str, **changes: float) -> float:
    return _settle(name, **changes).run.max_output_force_elastic


def _scales() -> Numbers:
    chain = scene("sec2")
    return [chain.K, scales_of(chain).phi, scaled_damping(chain), _elastic("sec2", D=50.0), _elastic("sec2")]


def _peaks() -> Numbers:
    points = peaks(_section_2())
    places = [value for p in points for value in (p.frequency, p.max_output_force_elastic)]
    return [*places, *(float(p.regime.period or 0) for p in points)]


def _dips() -> Numbers:
    points = dips(_section_2())
    same = {_words(p.regime) for p in points[:-1]}
    return [*(p.frequency for p in points[:-1]), " or ".join(sorted(same)), points[-1].frequency,
            _words(points[-1].regime)]


def _stop_band() -> Numbers:
    beyond = [p for p in _section_2().points if p.frequency >= 2000.0]
    return [max(p.max_output_force_elastic for p in beyond), beyond[-1].max_output_force_elastic]


def _energy() -> Numbers:
    states = [settle(scene(name), samples=_FINE) for name in ("fig3a", "fig3b")]
    ratios = [pushes(state.run) or (0, 0) for state in states]
    return [*(f"{strong}:{periods}" for strong, periods in ratios),
            *(1e6 * float(state.run.kinetic_energy.max()) for state in states)]


def _mass() -> Numbers:
    chain = scene("fig12-90")
    bead = chain.pattern[0]
    mass = 4.0 / 3.0 * math.pi * bead.radius**3 * _DENSITY
    rounded = periodic_orbit(chain)
    exact = periodic_orbit(replace(chain, pattern=(replace(bead, mass=mass),)), rounded.period, rounded.state)
    change = abs(exact.multipliers[0]) / abs(rounded.multipliers[0]) - 1.0
    return [1e3 * mass, abs(change / (mass / bead.mass - 1.0))]


def _shaker() -> Numbers:
    return [1e3 * 2.0 * math.pi * f * RIG_AMPLITUDE for f in (20.0, 60.0, 160.0)]


def _one_amplitude() -> Numbers:
    states = [_settle("rig", f=f, A0=RIG_AMPLITUDE, kappa=KAPPA) for f in (60.0, 90.0, 100.0)]
    forces = [one.run.max_output_force_elastic for one in states]
    return [forces[0], _words(states[0].regime), *forces[1:]]


def _four_amplitudes() -> Numbers:
    valley, peak = ([_settle("rig", f=f, A0=a, kappa=KAPPA) for a in MODEL_AMPLITUDES] for f in (90.0, 60.0))
    return [*(one.run.max_output_force_elastic for one in valley),
            " or ".join(sorted({_words(one.regime) for one in valley})),
            *(one.run.max_output_force_elastic for one in peak if one.regime.period),
            *(_words(one.regime) for one in peak if not one.regime.period)]


def _stiffness() -> Numbers:
    stiff = _settle("rig", k=KAPPA * scene("rig").K).run
    ends = [scene("rig").evolve(A0=a, kappa=KAPPA) for a in (MODEL_AMPLITUDES[0], MODEL_AMPLITUDES[-1])]
    return [stiff.max_output_force, stiff.max_input_force, *(one.k / 1e3 for one in ends),
            *(one.foundation_frequency for one in ends)]


def _output_force() -> Numbers:
    runs = [_settle("fig12-60").run, _settle("fig3b").run]
    return [force for one in runs for force in (one.max_output_force, one.max_output_force_elastic)]


def _model_3() -> Numbers:
    orbits = [periodic_orbit(scene(name), observer=True) for name in STATES.values()]
    return [float(np.abs(one.observer_multipliers).max()) for one in orbits if one.observer_multipliers is not None]


def _model_4() -> Numbers:
    parts = observers(None, (100.0, 200.0), periods=2).parts
    outside = [float(len(one.outside)) for one in parts]
    orbits = [one.twin.orbit for one in parts[:2]]
    return [*outside, float(np.abs(parts[0].outside).max()),
            *(float(np.abs(orbit.multipliers).max()) for orbit in orbits if orbit is not None)]


def _states() -> Numbers:
    states = [_settle(name) for name in STATES.values()]
    same = {_words(one.regime) for one in states}
    return [*(one.run.max_output_force_elastic for one in states), " or ".join(sorted(same))]


def _trains() -> Numbers:
    """Compute the presets at 90 and 50 Hz, then 100 Hz from rest with the amplitudes of `_two_solutions`."""
    presets = [_settle(STATES[f]) for f in (90.0, 100.0)]
    twice = scene(STATES[100.0]).evolve(f=100.0)
    gentle = [settle(chain, rest(chain)) for chain in (twice.evolve(A0=a, kappa=KAPPA) for a in (RIG_AMPLITUDE, 10e-6))]
    groups = presets, gentle, [settle(twice, rest(twice))]
    return [" or ".join(sorted({_words(one.regime) for one in group})) for group in groups]


def _two_solutions() -> Numbers:
    """Compute 100 Hz with the rig's amplitude, an intermediate one, and the preset's; then the preset at 50 Hz."""
    preset = scene("fig12-100")
    twice = preset.evolve(f=100.0)
    gentle = [attractors(twice.evolve(A0=a, kappa=KAPPA), 32) for a in (RIG_AMPLITUDE, 10e-6)]
    counts = {float(len(states)) for states in gentle}
    hard = settle(twice, rest(twice))
    of_preset = attractors(preset, 32)
    return [counts.pop() if len(counts) == 1 else math.nan,
            " or ".join(sorted({_words(one.regime) for states in gentle for one in states})), _words(hard.regime),
            float(len(of_preset)), " or ".join(sorted({_words(one.regime) for one in of_preset}))]


def _contact() -> Numbers:
    chain = scene("fig12-100")
    return [1e6 * chain.A0 * chain.f / 100.0, 1e3 * 2.0 * math.pi * chain.f * chain.A0]


_NUMBERS: dict[str, Callable[[], Numbers]] = {
    "scales": _scales, "peaks": _peaks, "dips": _dips, "stop band": _stop_band, "energy": _energy, "mass": _mass,
    "shaker": _shaker, "one amplitude": _one_amplitude, "stiffness": _stiffness, "four amplitudes": _four_amplitudes,
    "output force": _output_force, "model 3": _model_3, "model 4": _model_4, "states": _states, "trains": _trains,
    "two solutions": _two_solutions, "contact": _contact,
}


def numbers_of(key: str) -> Numbers:
    """Compute the bold entries of the row with this key: numbers in the row's units, and words."""
    if key not in _NUMBERS:
        raise unknown_name("row", key, _NUMBERS)
    return _NUMBERS[key]()
