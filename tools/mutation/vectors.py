"""Mutants of the equations' other copies: batches, short chains in one vector, long ones in blocks, their events."""

from __future__ import annotations

from . import killers as k
from .mutant import Mutant

_BATCH_STEP, _BATCH_RUN, _CORRECTION = "kernels/batch/step.py", "kernels/batch/run.py", "kernels/batch/contact_correction.py"
_LOOKS, _WIDE, _RUN, _ALONG = "kernels/batch/period_end.py", "kernels/rk4/short_chain.py", "kernels/rk4/short_chain_steps.py", "kernels/rk4/long_chain.py"
_MATH = "kernels/simd/functions.py"
_BATCH = "integrate/batch.py"

IN_BATCHES = (
    Mutant("batch-weights", _BATCH_STEP, "+ 2.0 * load_batch(stage.y2, row)", "+ load_batch(stage.y2, row)",
           "RK4 in batches with wrong weights", k.BATCH),
    Mutant("batch-foundation-on-neighbour", _BATCH_STEP, "left.e - e, left.u)", "left.e - e, right)",
           "the foundation pulls each bead by its neighbour's displacement", k.BATCH_FOUNDED),
    Mutant("batch-without-last-contact", _BATCH_STEP, "times_stiffness(values.unequal, values.wall, c, is_wall, d * r)",
           "times_stiffness(values.unequal, 0.0 * values.wall, c, is_wall, d * r)",
           "chains in batches do not feel the wall", k.BATCH),
    Mutant("batch-damping-of-one-side", _BATCH_STEP, "load_batch(source, bodies + i), left.shape - shape_right)",
           "load_batch(source, bodies + i), left.shape)", "a bead in batches is damped by one of its contacts", k.BATCH),
    Mutant("batch-output-force", _BATCH_STEP, "dashpot_force(values.law, last.overlap, last.rate)", "0.0 * last.rate",
           "the largest output force in batches leaves out the wall's dashpot", k.BATCH_FORCES),
    Mutant("batch-impulse-sign", _CORRECTION, "correct_state(values, y, c, bodies, gate(changed, impulse))",
           "correct_state(values, y, c, bodies, gate(changed, blank(overlap) - impulse))",
           "what a step beside an event gives too much is given once more", k.BATCH),
    Mutant("batch-events-not-corrected", _CORRECTION, "if positive_mask(changed) != 0:", "if positive_mask(changed) < 0:",
           "batches are of order 2", k.BATCH),
    Mutant("batch-path-of-dashpot", _CORRECTION, "- 1.0 / (2.0 + exponent(law)) * r * r_power", "- 0.5 / (2.0 + exponent(law)) * r * r_power",
           "what is taken back of a dashpot's path is wrong", k.BATCH_CHECKS),
    Mutant("batch-path-of-tsuji", _CORRECTION, "- 1.0 / (2.0 + exponent(law)) * r * r_power", "- 0.5 * r * r_power",
           "what is taken back of the path is wrong for Tsuji's law", k.BATCH_CHECKS),
    Mutant("batch-path-of-kuwabara-kono", _CORRECTION, "return primitive_factor(law) * law.coefficient * h * primitive_power(law, speed * h)",
           "return law.coefficient * h * primitive_power(law, speed * h)",
           "what is taken back of the path is wrong for Kuwabara and Kono's law", k.BATCH_CHECKS),
    Mutant("batch-wall-not-corrected", _CORRECTION, "for c in range(values.last + 1):", "for c in range(values.last):",
           "touches of the wall in batches are not corrected", k.BATCH_ONE),
    Mutant("batch-t-plus-dt", _LOOKS, "state.phase[0, member], state.phase[1, member] = 0.0, 1.0", "state.peaks[0, member] = 0.0",
           "the phase in batches turns on from period to period and is never set right", k.BATCH_PHASE),
    Mutant("batch-orbit-not-disturbed", _LOOKS, "if period > 0 and state.slowest[member] > 0.0:", "if period > 0 and state.slowest[member] > 2.0:",
           "an unstable orbit that extrapolation led to is drawn as periodic", k.BATCH_CHECKS),
    Mutant("batch-disturbance-always-decays", _LOOKS, "if last <= _PART_LEFT * first:", "if last < 1e300:",
           "an orbit is called stable though the disturbance grew", k.BATCH_CHECKS),
    Mutant("batch-jump-not-proved", _LOOKS, "proved = n > 0 and change < state.change_before_extrapolation[member]", "proved = True",
           "an extrapolation that led away is kept", k.BATCH_CHECKS),
    Mutant("batch-shadow-not-pulled-back", _BATCH_RUN, "* (start / now)", "* 1.0",
           "the exponent of batches is that of a distance long since large", k.LYAPUNOV),
    Mutant("batch-growth-from-zero", _BATCH_RUN, "= log(now / start)", "= log(now)",
           "growth in batches is counted from 1, not from the distance it began with", k.LYAPUNOV),
    Mutant("refill-into-old-overlaps", _BATCH, "state.y[:, member], state.overlaps[:, member] = y, 0.0", "state.y[:, member] = y",
           "the first step of the next scene in a place is corrected for contacts of the one before", k.REFILL),
    Mutant("refill-in-old-phase", _BATCH, "        state.phase[:, member] = 0.0, 1.0\n", "",
           "a scene that is put into a place while others move begins at the phase that stood there", k.REFILL),
    Mutant("refill-with-old-effects", _BATCH, "mine[0][:, member] = its[0]",
           "mine[0][:, member] += (mine[0][:, member] == 0.0) * its[0]",
           "the next scene in a place has damping, foundation and preload of the batch's first", k.REFILL),
    Mutant("refill-after-old-strobes", _BATCH, "y.reshape(2, -1), 1\n", "y.reshape(2, -1), max(1, state.strobe_count[member])\n",
           "the record of the next scene in a place begins with the strobes of the one before", k.REFILL),
    Mutant("refill-with-old-steps", _BATCH, "state.steps[member] = state.left[member] = steps",
           "state.steps[member], state.left[member] = state.steps[member] or steps, steps",
           "from its second period on the next scene in a place has the steps of the one before", k.REFILL),
    Mutant("refill-with-old-verdict", _BATCH, "state.fine_record[member], state.testing[member], state.due[member] = 0.0, 0, 0",
           "state.testing[member], state.due[member] = 0, 0", "the next scene in a place is checked as the finer run of the one before", k.REFILL),
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
    Mutant("nan-hidden-in-batches", _MATH, 'builder.select(builder.fcmp_ordered("<", args[0], least), least, args[0])',
           'builder.select(builder.fcmp_ordered(">", args[0], least), args[0], least)',
           "a NaN overlap in batches is an open contact", k.VECTORS),
    Mutant("nan-hidden-by-gate", _MATH, "return 0.0 if overlap <= 0.0 else value",
           "return value if overlap > 0.0 else 0.0", "a NaN overlap has no damping", k.VECTORS),
)

VECTORS = IN_BATCHES + IN_ROWS
