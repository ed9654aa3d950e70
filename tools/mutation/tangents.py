"""Mutants of the flow, its tangents in both forms, orbits and multipliers."""

from __future__ import annotations

from . import killers as k
from .mutant import Mutant

_TIME, _STEP, _EVENTS = "kernels/flow/event_time.py", "kernels/flow/attempt.py", "kernels/flow/events.py"
_FLOW, _TANGENT, _SALTATION = "kernels/flow/run.py", "kernels/flow/tangent.py", "kernels/flow/velocity_tangent.py"
_MAP, _ORBIT = "orbits/stroboscopic_map.py", "orbits/orbit.py"
_CIRCLE = "orbits/unit_circle.py"
_NORMAL_FORMS, _CRITICALITY = "orbits/branch/normal_forms.py", "orbits/branch/criticality.py"

#: Tangents in w that jump where those in v should have: exactly the effect of a forgotten saltation on them.
_WITHOUT_SALTATION = """from ..effects.dissipation import damping


@apply_saltation.of(Tangent)
def _(tangent, slots, c, closes):
    n = tangent.state.shape[0] // 2
    shear = damping(slots.dissipation, 1.0) if closes else -damping(slots.dissipation, 1.0)
    for first in range(0, tangent.matrix.shape[0], 2 * n):
        for q in range(8):
            d = (tangent.matrix[first + c - 1, q] if c > 0 else 0.0) - (tangent.matrix[first + c, q] if c < n else 0.0)
            if c > 0:
                tangent.matrix[first + n + c - 1, q] += shear * slots.chain.inverse_mass[c] * d
            if c < n:
                tangent.matrix[first + n + c, q] -= shear * slots.chain.inverse_mass[c + 1] * d
"""

FLOW = (
    Mutant("tsuji-in-square-root-time", _TIME, "return 2 if twice == int(twice) else 4", "return 2",
           "next to an event of Tsuji's law, nothing is smooth in the flow's time", k.MONODROMY_TSUJI),
    Mutant("rate-of-root-time", _TIME, "return 2.0 * s if transform.power == 2", "return 1.9 * s if transform.power == 2",
           "dt/ds is not the derivative of t(s)", k.ROUTES),
    Mutant("flow-without-last-contact", "kernels/effects/contact.py", "if frozen.closed[c] != 0 else 0.0",
           "if c < frozen.closed.size - 1 and frozen.closed[c] != 0 else 0.0",
           "the flow does not feel the wall", k.MONODROMY),
    Mutant("open-contacts-close-by-themselves", "kernels/effects/contact.py", "if frozen.closed[c] != 0 else 0.0", "if frozen.closed[c] < 2 else 0.0",
           "the flow's slope has a kink inside its steps", k.MONODROMY),
    Mutant("flow-steps-over-a-touch", _STEP, "if not (crossed or may_turn(d0, s0, d1, s1, sign)):", "if not crossed:",
           "a touch inside a step of the flow is not seen, nor is its contribution to the derivative", k.FLOW_TOUCH),
    Mutant("flow-closes-by-rounding", _STEP, "elif sign * s0 < 0.0 or sign * d0 >= 0.0:", "elif sign * d0 >= 0.0:",
           "the overlap of a contact that has just opened is rounding, whose root closes it again", k.FLOW_ROUNDING),
    Mutant("flow-driver-stands", _STEP, "beta * t_at(step.transform, x * step.h)", "beta * t_at(step.transform, step.h)",
           "the driver stands still while its contact is looked for", k.MONODROMY),
    Mutant("flow-event-tolerance-loose", _EVENTS, "_LARGEST_EVENT_OVERLAP = 1e-14", "_LARGEST_EVENT_OVERLAP = 1e-7",
           "the flow's events are located to 1e-7", k.MONODROMY),
    Mutant("closing-of-last-period-kept", _FLOW, "last_closing -= period", "last_closing -= 0.0",
           "time after a closing is counted from the wrong period", k.TWO_PERIODS),
    Mutant("events-logged-in-their-period", _FLOW, "toggle_contact(slots, contacts, tangent, contact, p * period + t)",
           "toggle_contact(slots, contacts, tangent, contact, t)", "the log's times restart in each period", k.SAME_EVENTS),
    Mutant("closing-not-remembered", _FLOW, "                    last_closing = t\n", "                    last_closing = -np.inf\n",
           "a step after a closing is taken in plain time, where nothing is smooth", k.MONODROMY),
)

TANGENTS = (
    Mutant("no-saltation", _FLOW, "apply_saltation.absent_for(Tangent)\n", _WITHOUT_SALTATION,
           "tangents continue across an event as if the dashpot's force did not jump there", k.COLUMNS, blind=k.LIOUVILLE),
    Mutant("no-saltation-in-second-route", _SALTATION, "shear = tangent.jumps * damping(slots.dissipation, 1.0)",
           "shear = 0.0 * tangent.jumps", "the (u, v) form without its jumps", k.ROUTES),
    Mutant("saltation-at-closing-only", _SALTATION, "        shear = -shear\n", "        shear = 0.0\n",
           "tangents do not jump at an opening", k.ROUTES),
    Mutant("saltation-of-one-side", _SALTATION, "if c > 0:\n            T[n + c - 1, q] -= shear",
           "if c > n:\n            T[n + c - 1, q] -= shear", "only the bead behind a contact feels its jump", k.ROUTES),
    Mutant("determinant-only-check", "tests/orbits/test_multipliers.py",
           "return float((np.abs(computed - exact).max(axis=0) / np.abs(exact).max(axis=0)).max())",
           "return float(abs(np.prod(np.linalg.svd(computed)[1]) / np.prod(np.linalg.svd(exact)[1]) - 1.0))",
           "a derivative is compared with the reference by its determinant, not column by column", ("tests/orbits/test_multipliers.py", "-k", "dashpot")),
    Mutant("determinant-only-comparison", "tests/orbits/test_tangents.py",
           "assert np.abs(wrong - right.derivative).max() > 0.05 * np.abs(right.derivative).max()",
           "assert abs(np.linalg.det(wrong) / np.linalg.det(right.derivative) - 1.0) > 0.05",
           "a missing saltation is looked for in the determinant", k.ROUTES),
    Mutant("tangent-stiffness", _TANGENT, "= dt_ds * elastic_slope(", "= dt_ds / 1.5 * elastic_slope(", "K √δ instead of (3/2) K √δ", k.COLUMNS),
    Mutant("tangent-without-damping", _TANGENT, "g = dt_ds * damping(law, d + TINY)", "g = 0.0 * d",
           "neighbours are not damped", k.COLUMNS),
    Mutant("trace-of-one-bead", _TANGENT, "(inverse_mass[c] + inverse_mass[c + 1])", "inverse_mass[c]",
           "∫ trace counts one of a contact's two beads", k.LIOUVILLE),
    Mutant("tangent-without-last-contact", _TANGENT, "acts = contacts.closed[c] != 0 and c >= tangent.first_contact",
           "acts = contacts.closed[c] != 0 and tangent.first_contact <= c < inverse_mass.size - 2",
           "neighbours do not feel the wall", k.COLUMNS),
    Mutant("observer-held-by-the-driver", _TANGENT, "and c >= tangent.first_contact", "and c >= 0",
           "an observer's multipliers are those of its chain", k.OBSERVER_ORBIT),
    Mutant("tangent-foundation-in-plain-time", "kernels/equations/body_forces.py", "slope, du, inverse_mass * dt_ds)", "slope, du, inverse_mass)",
           "the foundation's part of the tangents is not in the step's own time", k.FOUNDED_COLUMNS),
    Mutant("tangent-stage-weight", _TANGENT, "weights[stage, earlier] = h * A[stage, earlier]",
           "weights[stage, earlier] = h * A[STAGES, earlier] if stage > 6 else h * A[stage, earlier]",
           "tangents use the weights of other stages than the motion", k.COLUMNS),
)

ORBITS = (
    Mutant("velocity-of-one-contact", _MAP, "= -inverse * (gate[:-1] + gate[1:])", "= -inverse * gate[1:]",
           "∂v/∂u omits the contact on a bead's left", k.ROUTES),
    Mutant("newton-ends-early", "steady/residuals.py", "RESIDUAL_GOAL = 1e-11", "RESIDUAL_GOAL = 1e-7",
           "an orbit counts as found four digits too early",
           k.ORBIT_CLAIMS),
    Mutant("multipliers-by-real-part", _ORBIT, "np.argsort(-np.abs(multipliers), kind", "np.argsort(-multipliers.real, kind",
           "the leading multiplier is the rightmost, not the largest", ("tests/orbits/test_tangents.py", "-k", "sorted_by_modulus")),
    Mutant("stable-by-real-part", _CIRCLE, "np.abs(multipliers) >= least_modulus_outside(damped)",
           "np.real(multipliers) >= least_modulus_outside(damped)", "an orbit that alternates away is called stable",
           ("tests/orbits/test_modes.py", "-k", "doubling_left_unstable")),
    Mutant("residual-of-displacements", "steady/returns.py", "float(np.abs(change / sizes(x, least_displacement)).max())",
           "float(np.abs(change / sizes(x))[: len(x) // 2].max())",
           "an orbit's velocities need not return", k.ORBIT_CLAIMS),
    Mutant("liouville-of-leading", _ORBIT, "float(np.sum(np.log(np.abs(multipliers))))", "float(np.log(np.abs(multipliers[0])))",
           "Liouville's formula is compared with a single multiplier", k.ORBIT_CLAIMS),
    Mutant("map-tolerance-loose", _MAP, "TOLERANCE = 1e-13", "TOLERANCE = 1e-9",
           "the map is ten thousand times less exact than stated", k.MONODROMY),
)

NORMAL_FORMS = (
    Mutant("doubling-without-centre-manifold", _NORMAL_FORMS, "third @ right + 3.0 * second @ shift", "third @ right",
           "the centre manifold is taken for its tangent: the coefficient of a period doubling lacks its quadratic terms",
           k.NORMAL_FORMS),
    Mutant("curve-turned-the-other-way", _NORMAL_FORMS, "(0.5 * np.vdot(critical.left, cubic) / turn).real",
           "(0.5 * np.vdot(critical.left, cubic) * turn).real", "d is multiplied by the wrong rotation", k.NORMAL_FORMS),
    Mutant("subcritical-called-super", _NORMAL_FORMS, '(mean > 0.0) == (kind == "period_doubling")', "mean > 0.0",
           "Neimark–Sacker points have the sign of period doublings", k.NORMAL_FORMS),
    Mutant("any-two-values-agree", _NORMAL_FORMS, "_LARGEST_ERROR = 0.25", "_LARGEST_ERROR = 1e9",
           "a sign is reported that only one of two values has", k.NORMAL_FORMS),
    Mutant("differences-across-a-grazing", _CRITICALITY, "if not same_sequence(kind, flow.contact_events[:, 0], between.contacts(point)):",
           "if flow.derivative is None:", "states are used on whose way a contact closes once more", k.CRITICALITY),
    Mutant("order-in-the-interval-not-compared", _CRITICALITY,
           "            and same_sequence(special.kind, between.contacts(before), between.contacts(after))):", "            ):",
           "a normal form is computed across an event that passes phase 0", k.CRITICALITY),
)

TANGENT_FLOW = FLOW + TANGENTS + ORBITS + NORMAL_FORMS
