"""Contact damping g(δ) δ̇ whose primitive G (G' = g, G(0) = 0) makes the w-variables continuous.

Equation   F_d = λ g(δ) δ̇ H(δ)
             LinearDashpot   g = 1         G = δ              Zhang et al. 2016, eq. (1)
             Tsuji           g = δ^{1/4}   G = (4/5) δ^{5/4}  Tsuji, Tanaka & Ishida 1992
             KuwabaraKono    g = δ^{1/2}   G = (2/3) δ^{3/2}  Kuwabara & Kono 1987
Values     coefficient: λ in scaled units, at an overlap of one length unit for the last two
Terms      damping, primitive, keep_primitive, velocity (absent: v = w)
"""

from __future__ import annotations

from typing import NamedTuple

from ..jit import by_slot
from ..simd.functions import gate, root
from ..simd.vector import load


class LinearDashpot(NamedTuple):
    """Slot of the paper's dashpot."""

    coefficient: float


class Tsuji(NamedTuple):
    """Slot of damping ∝ δ^{1/4}, whose restitution does not depend on the impact speed."""

    coefficient: float


class KuwabaraKono(NamedTuple):
    """Slot of damping ∝ δ^{1/2}, the viscoelastic sphere."""

    coefficient: float


LAWS = (LinearDashpot, Tsuji, KuwabaraKono)
#: Those with g(0) = 0, whose force does not jump when a contact closes.
SMOOTH_LAWS = (Tsuji, KuwabaraKono)


@by_slot
def damping(law, d):
    """Force per speed of approach g(d) for d = [δ]_+; 0 where the contact is open."""
    return 0.0


@damping.of(LinearDashpot)
def _(law, d):
    return gate(d, law.coefficient)


@damping.of(Tsuji)
def _(law, d):
    return law.coefficient * root(root(d))


@damping.of(KuwabaraKono)
def _(law, d):
    return law.coefficient * root(d)


@by_slot
def damping_slope(law, d):
    """g'(d) for d = [δ]_+; 0 where the contact is open, though the last two have an infinite slope there."""
    return 0.0


@damping_slope.of(LinearDashpot)
def _(law, d):
    return 0.0


@damping_slope.of(Tsuji)
def _(law, d):
    return gate(d, 0.25 * law.coefficient / (root(d) * root(root(d))))


@damping_slope.of(KuwabaraKono)
def _(law, d):
    return gate(d, 0.5 * law.coefficient / root(d))


@by_slot
def primitive(law, d):
    """G(d) with G' = g and G(0) = 0."""
    return 0.0


@primitive.of(LinearDashpot)
def _(law, d):
    return law.coefficient * d


@primitive.of(Tsuji)
def _(law, d):
    return 0.8 * law.coefficient * d * root(root(d))


@primitive.of(KuwabaraKono)
def _(law, d):
    return 2.0 / 3.0 * law.coefficient * d * root(d)


@by_slot
def keep_primitive(law, G, c, d):
    """Store G of contact c; without dissipation there is no array to store it in."""


@by_slot
def put_primitive(law, G, c, value):
    """Store another value for G of contact c; without dissipation there is no array to store it in."""


@by_slot
def put_prescribed_primitive(law, G, source, target):
    """G of one contact is that of another too; without dissipation there is none."""


@by_slot
def velocity(law, inverse_mass, w, G, i):
    """v_i = w_i + (G_{i-1} − G_i)/m_i, the inverse of the change of variables."""
    return w


@by_slot
def shifted(law, inverse_mass, v, G, i):
    """w_i = v_i − (G_{i-1} − G_i)/m_i."""
    return v


@by_slot
def batch_values(law):
    """The law with the values of all lanes, read from its (1, 8) arrays; what multiplies `shape` in the first."""
    return None


@batch_values.of(LinearDashpot)
def _(law):
    return LinearDashpot(load(law.coefficient, 0))


@batch_values.of(Tsuji)
def _(law):
    return Tsuji(load(law.coefficient, 0))


@batch_values.of(KuwabaraKono)
def _(law):
    return KuwabaraKono(load(law.coefficient, 0))


@by_slot
def shape(law, d, r):
    """G over its coefficient, from d and r = √d."""
    return 0.0


@shape.of(LinearDashpot)
def _(law, d, r):
    return d


@shape.of(Tsuji)
def _(law, d, r):
    return 0.8 * d * root(r)


@shape.of(KuwabaraKono)
def _(law, d, r):
    return 2.0 / 3.0 * d * r


for _law in LAWS:

    @keep_primitive.of(_law)
    def _(law, G, c, d):
        G[c] = primitive(law, d)

    @put_primitive.of(_law)
    def _(law, G, c, value):
        G[c] = value

    @put_prescribed_primitive.of(_law)
    def _(law, G, source, target):
        G[target] = G[source]

    @velocity.of(_law)
    def _(law, inverse_mass, w, G, i):
        return w + inverse_mass[i] * (G[i - 1] - G[i])

    @shifted.of(_law)
    def _(law, inverse_mass, v, G, i):
        return v - inverse_mass[i] * (G[i - 1] - G[i])
