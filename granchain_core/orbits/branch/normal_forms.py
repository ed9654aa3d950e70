"""Normal forms of a map at a fold, a period doubling or a Neimark–Sacker point, and the criticality they imply.

Equation   the coefficients a of a fold, c of a period doubling and d of a Neimark–Sacker point, in docs/branches.md,
           "Criticality"
Source     Kuznetsov 2004, Elements of Applied Bifurcation Theory, 3rd edition: chapter 4, and the projection method of
           section 5.4
Note       B and C are central differences of the derivative M, so that no difference is of higher order than the
           second. They are valid only where the map is smooth: `MapNear.product` raises `NotSmooth` elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

#: Criticalities as spelled in JSON and files, where a nondegenerate fold has always been "generic".
SUPERCRITICAL, SUBCRITICAL, NONDEGENERATE, NOT_DECIDED = CRITICALITIES = (
    "supercritical", "subcritical", "generic", "not decided")

#: Why a criticality is not decided, as spelled in results, files and JSON.
SEQUENCE_IN_INTERVAL = "the sequence of contact events changes in the same interval of the knob"
SEQUENCE_NEAR = "the sequence of contact events changes within the smallest amplitude"
DISAGREE = "its two values disagree"
ANOTHER_MULTIPLIER = "another multiplier is at the unit circle"
NO_MULTIPLIER = "no multiplier of this kind is found on both sides"
RESONANCE = "strong resonance"
NO_MAP = "the map cannot be computed beside the orbit"
REASONS = (SEQUENCE_IN_INTERVAL, SEQUENCE_NEAR, DISAGREE, ANOTHER_MULTIPLIER, NO_MULTIPLIER, RESONANCE, NO_MAP)
#: Earlier spellings of two reasons, and the reasons that replace them when they are read.
EARLIER_REASONS = {"a contact grazes in the same interval of the knob": SEQUENCE_IN_INTERVAL,
                   "a contact grazes within the smallest amplitude": SEQUENCE_NEAR}

#: [branch] Amplitude γ of the differences of a period doubling or Neimark–Sacker point. Half of it is used on the
#: second side of the point. Rounding then changes the cubic coefficients of sec2, a few hundred to 20,000, by up to
#: 0.3.
_AMPLITUDE = 1e-4
#: [branch] Amplitude γ of a fold, which needs no second differences, and of the other kinds where `_AMPLITUDE` does not
#: decide.
_SMALL_AMPLITUDE = 2e-5
#: Amplitudes by kind, tried in this order.
AMPLITUDES = {"fold": (_SMALL_AMPLITUDE,), "period_doubling": (_AMPLITUDE, _SMALL_AMPLITUDE),
              "neimark_sacker": (_AMPLITUDE, _SMALL_AMPLITUDE)}
#: [branch] Largest difference between the two values of a coefficient, relative to their mean, at which its sign is
#: decided. Only an error of four times the difference would change the sign.
_LARGEST_ERROR = 0.25
#: [branch] Another multiplier is at the unit circle if its modulus is this near to 1. The passing one is mostly within
#: 5e-4.
_AT_CIRCLE = 1e-3
#: [branch] |μᵏ − 1|, k = 1 to 4, below which a resonance is strong. Near μ³ = 1 the coefficient grows as 1/|μ³ − 1|,
#: and the amplitude up to which it describes the motion falls accordingly.
_STRONG_RESONANCE = 0.02


class NotSmooth(Exception):
    """The map is not smooth, or not known, between the fixed point and a displaced state; the argument says why."""


@dataclass(frozen=True)
class NormalForm:
    """Criticality of a bifurcation point, with the coefficient that decides it.

    Attributes
    ----------
    criticality : str
        "supercritical" or "subcritical"; for a fold whose quadratic coefficient is not zero, "generic", meaning
        nondegenerate; or "not decided".
    coefficient : float
        |a| of a fold, c of a period doubling (supercritical: c > 0), Re d of a Neimark–Sacker point (supercritical:
        Re d < 0), in scaled units: γ is the amplitude along an eigenvector η whose entries have the root mean square 1.
        NaN where it was not computed.
    error : float
        Difference between two values, one from each side of the point, with different amplitudes. NaN where it was not
        computed.
    reason : str
        Why the criticality is not decided, one of `REASONS`; "" where it is decided.
    """

    criticality: str
    coefficient: float = np.nan
    error: float = np.nan
    reason: str = ""


@dataclass(frozen=True, eq=False)
class MapNear:
    """A map near one of its fixed points.

    `x` (n,) is the point and `derivative` (n, n) the map's derivative there. `product` gives the derivative at another
    state times the columns (n, m) of a matrix; it raises `NotSmooth` where the map between x and that state is not
    smooth.
    """

    x: np.ndarray
    derivative: np.ndarray
    product: Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class _Critical:
    """The multiplier that passes the unit circle, with its right and left eigenvectors η and ℓ."""

    multiplier: complex
    right: np.ndarray
    left: np.ndarray


def normal_form(kind: str, multiplier: complex, sides: tuple[MapNear, MapNear],
                amplitudes: Mapping[str, tuple[float, ...]] = AMPLITUDES) -> NormalForm:
    """Compute the normal form of a bifurcation point from the fixed points on both sides of it.

    Parameters
    ----------
    kind : str
        "fold", "period_doubling" or "neimark_sacker".
    multiplier : complex
        Approximately the multiplier that passes the unit circle; of a pair, the one above the real axis.
    sides : tuple of MapNear
        The map near a fixed point before the bifurcation and near one after it, close enough for their coefficients to
        agree.
    amplitudes : mapping of str to tuple of float
        For every kind, the amplitudes γ of the differences, tried in this order until one decides.
    """
    form = NormalForm(NOT_DECIDED)
    try:
        critical = [_critical(kind, multiplier, side.derivative) for side in sides]
        if kind == "neimark_sacker" and _resonant(critical[0].multiplier):
            raise NotSmooth(RESONANCE)
    except NotSmooth as obstacle:
        return NormalForm(NOT_DECIDED, reason=str(obstacle))
    if kind == "fold":  # the sign of a depends on that of η
        critical[1] = _with_sign_of(critical[1], critical[0])
    for amplitude in amplitudes[kind]:
        try:
            form = _judged(kind, *(_COEFFICIENTS[kind](side, vectors, size) for side, vectors, size in
                                   zip(sides, critical, (amplitude, 0.5 * amplitude), strict=True)))
        except NotSmooth as obstacle:
            form = NormalForm(NOT_DECIDED, reason=str(obstacle))
        if not form.reason:
            break
    return form


def _judged(kind: str, one: float, other: float) -> NormalForm:
    mean, error = 0.5 * (one + other), abs(one - other)
    if kind == "fold":
        mean = abs(mean)
    if not error < _LARGEST_ERROR * abs(mean):
        return NormalForm(NOT_DECIDED, mean, error, DISAGREE)
    if kind == "fold":
        return NormalForm(NONDEGENERATE, mean, error)
    return NormalForm(SUPERCRITICAL if (mean > 0.0) == (kind == "period_doubling") else SUBCRITICAL, mean, error)


# --- eigenvectors -------------------------------------------------------------------------------------------


def _critical(kind: str, multiplier: complex, derivative: np.ndarray) -> _Critical:
    """The eigenvalue of this kind that is nearest to `multiplier`, and its eigenvectors.

    Raises `NotSmooth` if there is none, or if another eigenvalue is at the unit circle.
    """
    eigenvalue, right = _nearest(kind, multiplier, derivative)
    _, left = _nearest(kind, multiplier.conjugate(), derivative.T)
    others = np.linalg.eigvals(derivative)
    of_this_kind = [int(np.argmin(np.abs(others - eigenvalue)))]
    if kind == "neimark_sacker":
        of_this_kind.append(int(np.argmin(np.abs(others - eigenvalue.conjugate()))))
    if (np.abs(np.abs(np.delete(others, of_this_kind)) - 1.0) < _AT_CIRCLE).any():
        raise NotSmooth(ANOTHER_MULTIPLIER)
    right = right * np.sqrt(len(right)) / np.linalg.norm(right)
    return _Critical(eigenvalue, right, left / np.vdot(right, left))


def _nearest(kind: str, multiplier: complex, matrix: np.ndarray) -> tuple[complex, np.ndarray]:
    """The eigenvalue nearest to `multiplier`, real or complex as the kind requires, with its eigenvector."""
    values, vectors = np.linalg.eig(matrix)
    distances = np.where((values.imag != 0.0) == (kind == "neimark_sacker"), np.abs(values - multiplier), np.inf)
    place = int(np.argmin(distances))
    if not np.isfinite(distances[place]):
        raise NotSmooth(NO_MULTIPLIER)
    vector = vectors[:, place]
    return complex(values[place]), vector if kind == "neimark_sacker" else vector.real


def _with_sign_of(vectors: _Critical, reference: _Critical) -> _Critical:
    """`vectors` with the signs chosen so that η points to the same side as the η of `reference`."""
    if vectors.right @ reference.right > 0.0:
        return vectors
    return _Critical(vectors.multiplier, -vectors.right, -vectors.left)


def _resonant(multiplier: complex) -> bool:
    """Whether μᵏ is near 1 for a k up to 4: a strong resonance, at which a closed curve is not guaranteed to exist."""
    on_circle = multiplier / abs(multiplier)
    return any(abs(on_circle**k - 1.0) < _STRONG_RESONANCE for k in (1, 2, 3, 4))


# --- coefficients -------------------------------------------------------------------------------------------


def _differences(near: MapNear, direction: np.ndarray, size: float,
                 columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """B(v, ·) and C(v, v, ·) times the columns, for the direction v, by central differences."""
    above, below = (near.product(near.x + step * direction, columns) for step in (size, -size))
    return (above - below) / (2.0 * size), (above - 2.0 * near.derivative @ columns + below) / size**2


def _fold(near: MapNear, critical: _Critical, size: float) -> float:
    """The coefficient a of γ²."""
    second, _ = _differences(near, critical.right, size, critical.right[:, np.newaxis])
    return float(0.5 * critical.left @ second[:, 0])


def _period_doubling(near: MapNear, critical: _Critical, size: float) -> float:
    """The coefficient c of γ³."""
    right, identity = critical.right, np.eye(len(near.x))
    second, third = _differences(near, right, size, identity)
    shift = np.linalg.solve(identity - near.derivative, second @ right)
    return float(critical.left @ (third @ right + 3.0 * second @ shift) / 6.0)


def _neimark_sacker(near: MapNear, critical: _Critical, size: float) -> float:
    """The real part of d; with η = η₁ + iη₂, C(η, η, η̄) = C(η₁, η₁, η) + C(η₂, η₂, η)."""
    right, identity = critical.right, np.eye(len(near.x))
    turn = critical.multiplier / abs(critical.multiplier)
    (second_a, third_a), (second_b, third_b) = (_differences(near, part, size, identity)
                                                for part in (right.real, right.imag))
    second, conjugate = second_a + 1j * second_b, second_a - 1j * second_b
    shift = np.linalg.solve(identity - near.derivative, second @ right.conj())
    double = np.linalg.solve(turn**2 * identity - near.derivative, second @ right)
    cubic = (third_a + third_b) @ right + 2.0 * second @ shift + conjugate @ double
    return float((0.5 * np.vdot(critical.left, cubic) / turn).real)


_COEFFICIENTS = {"fold": _fold, "period_doubling": _period_doubling, "neimark_sacker": _neimark_sacker}
