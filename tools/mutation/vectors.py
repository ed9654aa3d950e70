"""Mutants of the equations' other copies: lanes, short chains in one vector, long ones in blocks, their events."""

from __future__ import annotations

from . import killers as k
from .mutant import Mutant

_LANE, _LANES, _BESIDE = "kernels/batch/step.py", "kernels/batch/run.py", "kernels/batch/contact_correction.py"
_LOOKS, _WIDE, _RUN, _ALONG = "kernels/batch/period_end.py", "kernels/rk4/short_chain.py", "kernels/rk4/short_chain_steps.py", "kernels/rk4/long_chain.py"
_MATH = "kernels/simd/functions.py"

IN_LANES = (
    Mutant("lane-weights", _LANE, "before.u + 2.0 * u2, before.w + 2.0 * w2", "before.u + u2, before.w + u2",
           "RK4 in lanes with wrong weights", k.LANES),
    Mutant("lane-foundation-on-neighbour", _LANE, "bead.e - e, bead.u))", "bead.e - e, right))",
           "the foundation pulls each bead by its neighbour's displacement", k.LANES_FOUNDED),
    Mutant("lane-without-last-contact", _LANE, "times_stiffness(values.unequal, values.wall, c, values.last, d * r)",
           "times_stiffness(values.unequal, 0.0 * values.wall, c, values.last, d * r)",
           "chains in lanes do not feel the wall", k.LANES),
    Mutant("lane-damping-of-one-side", _LANE, "batch_velocity(values.law, values.unequal, i, bead.w, bead.G - G)",
           "batch_velocity(values.law, values.unequal, i, bead.w, bead.G)", "a bead in lanes is damped by one of its contacts", k.LANES),
    Mutant("lane-output-force", _LANE, "dashpot_force(values.law, last.gap, last.rate)", "0.0 * last.rate",
           "the largest output force in lanes leaves out the wall's dashpot", k.LANE_FORCES),
    Mutant("lane-impulse-sign", _BESIDE, "correct_state(values, y, c, m, gate(changed, impulse))",
           "correct_state(values, y, c, m, gate(changed, blank(gap) - impulse))",
           "what a step beside an event gives too much is given once more", k.LANES),
    Mutant("lane-events-not-corrected", _BESIDE, "if positive_mask(changed) != 0:", "if positive_mask(changed) < 0:",
           "lanes are of order 2", k.LANES),
    Mutant("lane-path-of-dashpot", _BESIDE, "- 1.0 / (2.0 + exponent(law)) * r * here", "- 0.5 / (2.0 + exponent(law)) * r * here",
           "what is taken back of a dashpot's path is wrong", k.LANE_LOOKS),
    Mutant("lane-path-of-tsuji", _BESIDE, "- 1.0 / (2.0 + exponent(law)) * r * here", "- 0.5 * r * here",
           "what is taken back of the path is wrong for Tsuji's law", k.LANE_LOOKS),
    Mutant("lane-path-of-kuwabara-kono", _BESIDE, "return primitive_factor(law) * law.coefficient * h * primitive_power(law, speed * h)",
           "return law.coefficient * h * primitive_power(law, speed * h)",
           "what is taken back of the path is wrong for Kuwabara and Kono's law", k.LANE_LOOKS),
    Mutant("lane-wall-not-corrected", _BESIDE, "for c in range(values.last + 1):", "for c in range(values.last):",
           "touches of the wall in lanes are not corrected", k.LANES_ONE),
    Mutant("lane-t-plus-dt", _LOOKS, "state.phase[0, lane], state.phase[1, lane] = 0.0, 1.0", "state.peaks[0, lane] = 0.0",
           "the phase in lanes turns on from period to period and is never set right", k.LANE_PHASE),
    Mutant("lane-orbit-not-disturbed", _LOOKS, "if period > 0 and state.slowest[lane] > 0.0:", "if period > 0 and state.slowest[lane] > 2.0:",
           "an unstable orbit that extrapolation led to is drawn as periodic", k.LANE_LOOKS),
    Mutant("lane-disturbance-always-decays", _LOOKS, "if last <= _LEFT * first:", "if last < 1e300:",
           "an orbit is called stable though the disturbance grew", k.LANE_LOOKS),
    Mutant("lane-jump-not-proved", _LOOKS, "proved = n > 0 and change < state.change_before_extrapolation[lane]", "proved = True",
           "an extrapolation that led away is kept", k.LANE_LOOKS),
    Mutant("lane-shadow-not-pulled-back", _LANES, "* (start / now)", "* 1.0",
           "the exponent of lanes is that of a distance long since large", k.LYAPUNOV),
    Mutant("lane-growth-from-zero", _LANES, "= log(now / start)", "= log(now)",
           "growth in lanes is counted from 1, not from the distance it began with", k.LYAPUNOV),
)

IN_ROWS = (
    Mutant("wide-weights", _WIDE, "x.u + sixth * (x.du + du4 + 2.0 * (du2 + du3)) + shift", "x.u + sixth * (x.du + du4 + du2 + du3) + shift",
           "RK4 of short chains with wrong weights", k.SIMD_PLAIN),
    Mutant("wide-given-back-sign", _WIDE, "values.inverse_mass * (excess - from_left(blank(excess), excess))",
           "values.inverse_mass * (from_left(blank(excess), excess) - excess)",
           "short chains are given once more what Simpson's rule gives too much", k.SIMD_PLAIN),
    Mutant("wide-damping-of-one-side", _WIDE, "damping_over_mass * (from_left(blank(shapes), shapes) - shapes)",
           "damping_over_mass * (blank(shapes) - shapes)", "a bead of a short chain is damped by one of its contacts", k.SIMD_PLAIN),
    Mutant("wide-driver-at-rest", _WIDE, "moving = with_first(du, v0)", "moving = with_first(du, 0.0 * v0)",
           "short chains do not know how fast their driver comes", k.SIMD_PLAIN),
    Mutant("wide-steps-over-touch", _RUN, "(closed_after ^ closed) | ((rising ^ closed) & ~(rising_after ^ closed)) != 0",
           "(closed_after ^ closed) != 0", "a touch inside a step of a short chain is not seen", k.STEP_TOUCH),
    Mutant("wide-split-phase", _RUN, "theta + dtheta * (done + 0.5 * part), theta", "theta + dtheta * (done + part), theta",
           "the driver is ahead in the middle of a split step", k.SIMD_PLAIN),
    Mutant("along-last-stage", _ALONG, "later_stage(simd, slots, end, simd.first", "later_stage(simd, slots, middle, simd.first",
           "the driver of a long chain is half a step late", k.SIMD_LONG),
    Mutant("along-damping-sign", _ALONG, "inverse_mass * (from_left(before, G) - G)", "inverse_mass * (G - from_left(before, G))",
           "damping drives a long chain", k.SIMD_LONG),
    Mutant("along-block-borders", _ALONG, "here, e_before, G_before = ahead, e, G", "here, e_before = ahead, e",
           "a bead at the border of two blocks is damped by the wrong contact", k.SIMD_LONG, which=1, count=2),
    Mutant("along-event-overrun", _ALONG, "return done - 1", "return done", "a step in which a contact changes is not split", k.SIMD_LONG),
    Mutant("nan-hidden-in-vectors", _MATH, 'builder.select(builder.fcmp_ordered("<", args[0], zero), zero, args[0])',
           'builder.select(builder.fcmp_ordered(">", args[0], zero), args[0], zero)',
           "`if d > 0` in every lane: a NaN overlap is an open contact", k.VECTORS),
    Mutant("nan-hidden-in-lanes", _MATH, 'builder.select(builder.fcmp_ordered("<", args[0], least), least, args[0])',
           'builder.select(builder.fcmp_ordered(">", args[0], least), args[0], least)',
           "a NaN overlap in lanes is an open contact", k.VECTORS),
    Mutant("nan-hidden-by-gate", _MATH, "return 0.0 if overlap <= 0.0 else value",
           "return value if overlap > 0.0 else 0.0", "a NaN overlap has no damping", k.VECTORS),
)

VECTORS = IN_LANES + IN_ROWS
