"""Normal forms of exactly known maps are right, and uncertain ones are not decided."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from granchain_core.orbits.branch.normal_forms import (
    ANOTHER_MULTIPLIER,
    DISAGREE,
    NO_MULTIPLIER,
    NONDEGENERATE,
    NOT_DECIDED,
    RESONANCE,
    SEQUENCE_NEAR,
    SUBCRITICAL,
    SUPERCRITICAL,
    MapNear,
    NormalForm,
    NotSmooth,
    normal_form,
)

#: Derivative (n, n) of a map at x (n,).
Derivative = Callable[[np.ndarray], np.ndarray]
#: Distance of the knob from its critical value on both sides.
_BESIDE = 1e-6


def near(derivative: Derivative, x: list[float]) -> MapNear:
    """Return a map that is smooth everywhere, near its fixed point x."""
    point = np.array(x)
    return MapNear(point, derivative(point), lambda y, columns: derivative(y) @ columns)


def form_of(kind: str, multiplier: complex, family: Callable[[float], MapNear]) -> NormalForm:
    """Return the normal form of a family of maps at its critical value 0."""
    return normal_form(kind, multiplier, (family(-_BESIDE), family(_BESIDE)))


def linear_and(cubic: float, eigenvalue: float, power: float = 3.0) -> Callable[[float], MapNear]:
    """Return the map x → eigenvalue (1 + β) x + cubic |x|^power sign x."""
    return lambda beta: near(lambda x: np.array([[eigenvalue * (1.0 + beta) + cubic * power * abs(x[0]) ** (power - 1.0)]]),
                             [0.0])


def logistic(beta: float) -> MapNear:
    """Return the logistic map x → r x (1 − x), which doubles its period at r = 3."""
    r = 3.0 + beta
    return near(lambda x: np.array([[r * (1.0 - 2.0 * x[0])]]), [1.0 - 1.0 / r])


def test_the_logistic_map_doubles_supercritically() -> None:
    form = form_of("period_doubling", -1.0, logistic)  # c = (f″/2)² + f‴/6 with f″ = −6
    assert form.criticality == SUPERCRITICAL and form.reason == ""
    assert form.coefficient == pytest.approx(9.0, abs=form.error + 1e-6) and form.error < 1e-3


def test_a_cubic_of_the_other_sign_doubles_subcritically() -> None:
    form = form_of("period_doubling", -1.0, linear_and(-1.0, -1.0))
    assert form.criticality == SUBCRITICAL and form.coefficient == pytest.approx(-1.0, abs=1e-5)


def henon(a: float, b: float = 0.3) -> MapNear:
    """Return the Hénon map (x, y) → (1 − a x² + y, b x) near its fixed point."""
    x = (b - 1.0 + np.sqrt((1.0 - b) ** 2 + 4.0 * a)) / (2.0 * a)
    return near(lambda z: np.array([[-2.0 * a * z[0], 1.0], [b, 0.0]]), [x, b * x])


def test_the_coefficient_is_that_of_henons_cycle() -> None:
    """Its 2-cycle, x = ((1 − b) ± √(4a − 3(1 − b)²))/(2a), is at γ² = β/c where the multiplier is −1 − β."""
    b = 0.3
    critical = 0.75 * (1.0 - b) ** 2
    form = form_of("period_doubling", -1.0, lambda beta: henon(critical + beta))
    beyond = critical * (1.0 + 1e-5)
    values, vectors = np.linalg.eig(henon(beyond).derivative)
    smallest = int(np.argmin(values))
    right = vectors[:, smallest] * np.sqrt(2.0) / np.linalg.norm(vectors[:, smallest])
    half_width = np.sqrt(4.0 * beyond - 3.0 * (1.0 - b) ** 2) / (2.0 * beyond)
    expected = (-1.0 - values[smallest]) / (half_width / right[0]) ** 2
    assert form.criticality == SUPERCRITICAL
    assert form.coefficient == pytest.approx(expected, rel=1e-4)  # higher orders: the distance 1e-5


def turning(angle: float, cubic: complex) -> Callable[[float], MapNear]:
    """Return the map z → e^{i angle} z (1 + β + cubic |z|²) in the plane of (Re z, Im z)."""
    def derivative(x: np.ndarray, beta: float) -> np.ndarray:
        z, turn = complex(*x), np.exp(1j * angle)
        along, across = (turn * (1.0 + beta + 2.0 * cubic * abs(z) ** 2), turn * cubic * z**2)  # ∂/∂z, ∂/∂z̄
        columns = along + across, 1j * (along - across)
        return np.array([[one.real for one in columns], [one.imag for one in columns]])

    return lambda beta: near(lambda x: derivative(x, beta), [0.0, 0.0])


@pytest.mark.parametrize(("cubic", "criticality"), [(-0.7 + 3.0j, SUPERCRITICAL), (0.4 - 5.0j, SUBCRITICAL)])
def test_a_closed_curve_is_attracting_or_repelling(cubic: complex, criticality: str) -> None:
    form = form_of("neimark_sacker", np.exp(1.0j), turning(1.0, cubic))
    assert form.criticality == criticality
    assert form.coefficient == pytest.approx(4.0 * cubic.real, rel=1e-4)  # z = 2γ, since η = (1, ∓i) has the norm √2


@pytest.mark.parametrize("k", [3, 4])
def test_a_strong_resonance_is_not_decided(k: int) -> None:
    angle = 2.0 * np.pi / k + 1e-3
    form = form_of("neimark_sacker", np.exp(1j * angle), turning(angle, -1.0))
    assert (form.criticality, form.reason) == (NOT_DECIDED, RESONANCE) and np.isnan(form.coefficient)


def delayed(r: float) -> MapNear:
    """Return the delayed logistic map (x, y) → (r x (1 − y), x) near its fixed point 1 − 1/r."""
    return near(lambda z: np.array([[r * (1.0 - z[1]), -r * z[0]], [1.0, 0.0]]), [1.0 - 1.0 / r] * 2)


def test_the_curve_of_the_delayed_logistic_map_has_the_radius_that_the_coefficient_gives() -> None:
    """Beyond r = 2, where the map rotates by 60°, |γ|² = −β/Re d with β = |μ| − 1."""
    form = form_of("neimark_sacker", np.exp(1j * np.pi / 3.0), lambda beta: delayed(2.0 + beta))
    assert form.criticality == SUPERCRITICAL
    for beyond in (1e-3, 4e-3):
        r = 2.0 + beyond
        values, vectors = np.linalg.eig(delayed(r).derivative)
        upper = int(np.argmax(values.imag))
        right = vectors[:, upper] * np.sqrt(2.0) / np.linalg.norm(vectors[:, upper])
        left = np.linalg.inv(np.column_stack([right, right.conj()]))[0]
        x, y = 0.5 + 0.02, 0.5
        squares = []
        for step in range(40_000):
            x, y = r * x * (1.0 - y), x
            if step >= 30_000:
                squares.append(abs(left @ np.array([x - 1.0 + 1.0 / r, y - 1.0 + 1.0 / r])) ** 2)
        expected = -(abs(values[upper]) - 1.0) / form.coefficient
        assert np.mean(squares) == pytest.approx(expected, rel=0.05)  # the next order: |z|² itself


def folding(quadratic: float, beta: float) -> Callable[[float], MapNear]:
    """Return the map x → x + β² − quadratic x² at its fixed points ±β/√quadratic."""
    return lambda side: near(lambda x: np.array([[1.0 - 2.0 * quadratic * x[0]]]), [np.sign(side) * beta / np.sqrt(quadratic)])


def test_a_fold_is_nondegenerate_where_its_quadratic_coefficient_is_not_zero() -> None:
    form = form_of("fold", 1.0, folding(2.5, 1e-3))
    assert form.criticality == NONDEGENERATE and form.coefficient == pytest.approx(2.5, rel=1e-6)
    form = form_of("fold", 1.0, linear_and(-1.0, 1.0))  # a pitchfork
    assert (form.criticality, form.reason) == (NOT_DECIDED, DISAGREE)


def test_no_sign_is_stated_without_evidence() -> None:
    grazing = form_of("period_doubling", -1.0, linear_and(1.0, -1.0, power=1.5))  # its third derivative is unbounded
    assert (grazing.criticality, grazing.reason) == (NOT_DECIDED, DISAGREE)
    none = form_of("period_doubling", -1.0, linear_and(0.0, -1.0))
    assert (none.criticality, none.reason) == (NOT_DECIDED, DISAGREE)
    two = form_of("period_doubling", -1.0, lambda _: near(lambda x: np.diag([-1.0, 1.0]), [0.0, 0.0]))
    assert (two.criticality, two.reason) == (NOT_DECIDED, ANOTHER_MULTIPLIER)
    pair = form_of("period_doubling", -1.0, turning(3.0, -1.0))
    assert (pair.criticality, pair.reason) == (NOT_DECIDED, NO_MULTIPLIER)


@pytest.mark.parametrize(("smooth_to", "criticality", "reason"), [
    (1.0, SUPERCRITICAL, ""), (5e-5, SUPERCRITICAL, ""), (1e-5, NOT_DECIDED, SEQUENCE_NEAR)])
def test_no_state_beyond_a_grazing_is_used(smooth_to: float, criticality: str, reason: str) -> None:
    def side(beta: float) -> MapNear:
        smooth = logistic(beta)

        def product(x: np.ndarray, columns: np.ndarray) -> np.ndarray:
            if abs(x[0] - smooth.x[0]) > smooth_to:
                raise NotSmooth(SEQUENCE_NEAR)
            return smooth.product(x, columns)

        return MapNear(smooth.x, smooth.derivative, product)

    form = form_of("period_doubling", -1.0, side)
    assert (form.criticality, form.reason) == (criticality, reason)
