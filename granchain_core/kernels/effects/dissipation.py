"""Contact damping g(δ) δ̇; its primitive G (G' = g, G(0) = 0) defines w, whose rate ẇ has no jump.

Equation   F_d = λ δ^a δ̇ H(δ),   g = λ δ^a,   G = λ δ^{1+a}/(1 + a)
             LinearDashpot   a = 0     Zhang et al. 2016, eq. (1)
             Tsuji           a = 1/4   Tsuji, Tanaka & Ishida 1992
             KuwabaraKono    a = 1/2   Kuwabara & Kono 1987
Values     coefficient: λ = D (A₀/δ_r)^a/(mφ), at an overlap of one length unit where a > 0
Law        defined by its `exponent` a and its `power` δ^a; all other terms follow from these, here and elsewhere
Terms      damping, damping_slope, dashpot_force, closing_force, dashpot_slope, primitive, times_primitive,
           unit_primitive = G/λ, v_from_w and its inverse w_from_v (absent: v = w); write_primitive, put_primitive and
           copy_primitive write into the array of G
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..compiling.dispatch import by_slot, by_slot_inlined, require_terms
from ..compiling.jit import inline_llvm
from ..simd.functions import gate, positive_part, root
from ..simd.vector import load_batch
from .batch_values import batch_values
from .contact import TINY
from .registry import in_simd_kernels


@by_slot_inlined
def exponent(law):
    """Exponent a of g = λ δ^a. It must return a literal, so that the compiler can fold everything computed from it."""
    return 0.0


@by_slot_inlined
def power(law, d, r):
    """δ^a from d = [δ]_+ and r = √d, for numbers and vectors. An unused root is not computed."""
    return 0.0


class LinearDashpot(NamedTuple):
    """Slot of the paper's linear dashpot."""

    coefficient: float


@exponent.of(LinearDashpot)
def _(law):
    return 0.0


@power.of(LinearDashpot)
def _(law, d, r):
    return 1.0


class Tsuji(NamedTuple):
    """Slot of damping ∝ δ^{1/4}, whose restitution does not depend on the impact speed."""

    coefficient: float


@exponent.of(Tsuji)
def _(law):
    return 0.25


@power.of(Tsuji)
def _(law, d, r):
    return root(r)


class KuwabaraKono(NamedTuple):
    """Slot of damping ∝ δ^{1/2}: viscoelastic spheres."""

    coefficient: float


@exponent.of(KuwabaraKono)
def _(law):
    return 0.5


@power.of(KuwabaraKono)
def _(law, d, r):
    return r


def checked(*laws):
    """Check that each law is complete and return the laws; a TypeError names the law and its fault."""
    for law in laws:
        require_terms(law, exponent, power)
        if law._fields != ("coefficient",):
            raise TypeError(f"damping law {law.__name__} has the fields {law._fields}; it needs `coefficient` alone.")
        a = exponent(law(1.0))
        if not 0.0 <= a < 1.5 or 4.0 * a % 1.0 != 0.0:
            raise TypeError(f"damping law {law.__name__} has the exponent {a}; the time of contact events "
                            f"(flow/event_time.py) takes 0, 1/4, 1/2, … 5/4.")
        if any(not math.isclose(power(law(1.0), d, math.sqrt(d)), d**a) for d in (0.3, 1.0, 2.0)):
            raise TypeError(f"damping law {law.__name__}: `power` is not δ^{a}, which its `exponent` says.")
        in_simd_kernels("rk4", "batch", "dop853_root")(law)  # these kernels use the same two terms
    return laws


#: Every slot class for which an exponent or a power has been registered.
LAWS = checked(*(slot for slot in exponent.implementations | power.implementations if slot is not type(None)))
#: Laws with g(0) > 0, whose force jumps when a contact closes, and laws with g(0) = 0.
JUMP_LAWS = tuple(law for law in LAWS if exponent(law(1.0)) == 0.0)
SMOOTH_LAWS = tuple(law for law in LAWS if law not in JUMP_LAWS)


@by_slot
def damping(law, d):
    """Force per approach speed, g(d), for d = [δ]_+; 0 where the contact is open."""
    return 0.0


@damping.of(*JUMP_LAWS)
def _(law, d):
    return gate(d, law.coefficient)


@damping.of(*SMOOTH_LAWS)
def _(law, d):
    return law.coefficient * power(law, d, root(d))


@by_slot_inlined
def dashpot_force(law, overlap, rate):
    """F_d = g([δ]_+) δ̇, which is added to a contact's elastic force; for numbers and vectors."""
    return 0.0


@dashpot_force.of(*LAWS)
def _(law, overlap, rate):
    return damping(law, positive_part(overlap)) * rate


@by_slot
def closing_force(law, rate):
    """g(0+) δ̇, the force just after the contact closes."""
    return 0.0


@closing_force.of(*LAWS)
def _(law, rate):
    return damping(law, TINY) * rate


@by_slot
def damping_slope(law, d):
    """g'(d) for d = [δ]_+; 0 where the contact is open, although the limit at d = 0 is infinite for 0 < a < 1."""
    return 0.0


damping_slope.absent_for(*JUMP_LAWS)


@damping_slope.of(*SMOOTH_LAWS)
def _(law, d):
    return gate(d, exponent(law) * law.coefficient * power(law, d, root(d)) / d)


@by_slot
def dashpot_slope(law, d, rate, acceleration):
    """Ḟ_d = g'(d) δ̇² + g(d) δ̈ from d = [δ]_+, δ̇ and δ̈."""
    return 0.0


@dashpot_slope.of(*LAWS)
def _(law, d, rate, acceleration):
    return damping_slope(law, d) * rate * rate + damping(law, d) * acceleration


@inline_llvm
def primitive_factor(law):
    """1/(1 + a), the factor of G."""
    return 1.0 / (1.0 + exponent(law))


@inline_llvm
def primitive_power(law, s):
    """s^{1+a}, the power of G."""
    return s * power(law, s, root(s))


@by_slot
def primitive(law, d):
    """G(d) with G' = g and G(0) = 0."""
    return 0.0


@primitive.of(*LAWS)
def _(law, d):
    return primitive_factor(law) * law.coefficient * d * power(law, d, root(d))


@by_slot
def times_primitive(law, G, rate):
    """G times a rate, for the energy account."""
    return 0.0


@times_primitive.of(*LAWS)
def _(law, G, rate):
    return G * rate


@by_slot
def unit_primitive(law, d, r):
    """G/λ: the primitive G over its coefficient, from d and r = √d."""
    return 0.0


@unit_primitive.of(*LAWS)
def _(law, d, r):
    return primitive_factor(law) * d * power(law, d, r)


@by_slot
def write_primitive(law, G, c, d):
    """Store G of contact c. Effect absent: nothing, since there is no array for it."""


@write_primitive.of(*LAWS)
def _(law, G, c, d):
    G[c] = primitive(law, d)


@by_slot
def put_primitive(law, G, c, value):
    """Store a given value of G of contact c. Effect absent: nothing, since there is no array for it."""


@put_primitive.of(*LAWS)
def _(law, G, c, value):
    G[c] = value


@by_slot
def copy_primitive(law, G, source, target):
    """Copy G of contact `source` to contact `target`. Effect absent: nothing, since there is no array for it."""


@copy_primitive.of(*LAWS)
def _(law, G, source, target):
    G[target] = G[source]


@by_slot
def v_from_w(law, inverse_mass, w, G, i):
    """v_i = w_i + (G_{i-1} − G_i)/m_i, the inverse of the change of variables."""
    return w


@v_from_w.of(*LAWS)
def _(law, inverse_mass, w, G, i):
    return w + inverse_mass[i] * (G[i - 1] - G[i])


@by_slot
def w_from_v(law, inverse_mass, v, G, i):
    """w_i = v_i − (G_{i-1} − G_i)/m_i."""
    return v


@w_from_v.of(*LAWS)
def _(law, inverse_mass, v, G, i):
    return v - inverse_mass[i] * (G[i - 1] - G[i])


def _read_for_batch(slot):
    """Register `batch_values` for a law: a compiled function can only construct a class that is named in its source."""

    @batch_values.of(slot)
    def _(law):
        return slot(load_batch(law.coefficient, 0))


for _law in LAWS:
    _read_for_batch(_law)
