"""Mutants of how time goes on: the equations of motion, fixed steps and what they give back, error control."""

from __future__ import annotations

from . import killers as k
from .mutant import Mutant

_MOTION, _FIXED, _EVENTS = "kernels/equations/motion.py", "kernels/rk4/step.py", "kernels/rk4/contact_events.py"
_LOCATED, _CONTROLLED_RUN = "kernels/error_control/located_step.py", "kernels/error_control/run.py"
_CONTROL, _DOP853, _TABLEAU = "kernels/error_control/step.py", "kernels/dop853/step.py", "kernels/dop853/tableau.py"
_BRACKET, _CUBIC = "kernels/error_control/bracket.py", "kernels/contact_cubic.py"
_SAMPLING, _ENGINE = "kernels/rk4/run.py", "integrate/engine.py"

MOTION = (
    Mutant("motion-without-last-contact", _MOTION, "for c in range(bodies - 1):\n        d = closed_overlap(forces.frozen, c, overlap(slots.preload, y, c))\n        e[c] =",
           "for c in range(bodies - 2):\n        d = closed_overlap(forces.frozen, c, overlap(slots.preload, y, c))\n        e[c] =",
           "the wall's contact is not summed", k.MOTION),
    Mutant("contact-force-elastic-only", _MOTION, "e[c] + damped)",
           "e[c])", "forces are reported without their damping", k.MOTION),
    Mutant("foundation-over-first-mass", _MOTION,
           "inverse_mass[i] * force_on_bead(slots, i, e[i - 1] - e[i], y[i], dy[i])",
           "force_on_bead(slots, i, inverse_mass[i] * (e[i - 1] - e[i]), y[i], dy[i])",
           "the foundation's pull on a heavy bead is not divided by its mass", k.UNLIKE),
    Mutant("kinetic-energy-of-equal-beads", _MOTION, "0.5 * dy[i] * dy[i] / inverse_mass[i]",
           "0.5 * dy[i] * dy[i] * inverse_mass[i]", "the kinetic energy of a heavy bead is too small", k.UNLIKE),
    Mutant("start-velocity-taken-for-w", _MOTION, "    if from_velocity:\n", "    if from_velocity and bodies < 0:\n",
           "a state in velocities is taken for one in w", k.MOTION),
)

FIXED = (
    Mutant("rk4-weights", _FIXED, "h / 6.0 * (k[0, i] + 2.0 * (k[1, i] + k[2, i]) + k[3, i])",
           "h / 8.0 * (k[0, i] + 3.0 * (k[1, i] + k[2, i]) + k[3, i])", "order 2 in place of 4", k.RK4_ORDER),
    Mutant("rk4-half-step", _FIXED, "stage[i] = y[i] + 0.5 * h * k[1, i]", "stage[i] = y[i] + 0.5 * h * k[0, i]",
           "the third stage starts from the first slope", k.RK4_ORDER),
    Mutant("scalar-split-steps-over-touch", _FIXED,
           "changed |= (before ^ after) | turns(before, rising, risen)", "changed |= before ^ after",
           "a contact that closes and opens again inside a step is not seen", k.EVENT_TESTS),
    Mutant("scalar-give-back-sign", _FIXED, "y[bodies + i] += inverse_mass[i] * (ends[MOMENTUM_ERROR", "y[bodies + i] -= inverse_mass[i] * (ends[MOMENTUM_ERROR",
           "what Simpson's rule gives too much is given once more", k.SIMD_PLAIN),
    Mutant("scalar-split-phase", _FIXED, "theta + dtheta * (done + 0.5 * part), theta", "theta + dtheta * (done + part), theta",
           "the driver is ahead in the middle of a split step", k.SIMD_PLAIN),
    Mutant("give-back-work-sign", _FIXED, "y[y.size - 2] -= excess", "y[y.size - 2] += excess",
           "the driver's work keeps what was given back", k.STEP_EVENTS),
    Mutant("hermite-slope", _CUBIC, "a = 2.0 * (d0 - d1) + s0 + s1", "a = 2.0 * (d0 - d1) + s0 - s1",
           "events inside a fixed step are in the wrong place", k.STEP_EVENTS, which=1, count=2),
    Mutant("hermite-turn", _CUBIC, "a = 2.0 * (d0 - d1) + s0 + s1", "a = 2.0 * (d0 - d1) + s0 - s1",
           "a touch inside a fixed step is looked for in the wrong place", k.STEP_EVENTS, which=2, count=2),
    Mutant("simpson-wrong-side", _EVENTS, "1.0 - done if rate > 0.0 else done", "done if rate > 0.0 else 1.0 - done",
           "the excess is taken over the open part of the step", k.STEP_EVENTS),
    Mutant("simpson-not-given-back", _EVENTS, "return (part + whole) / 6.0 - 1.0 / (p + 1.0) * (r + 2.0) * far", "return 0.0 * (part + whole * far * p)",
           "the impulse beside an event is off by a part of h^{5/2}", k.STEP_EVENTS),
    Mutant("simpson-one-step-too-few", _EVENTS, "* (r + 2.0) * far", "* (r + 1.0) * far",
           "the excess is integrated one step too short", k.STEP_EVENTS),
    Mutant("simpson-tsuji-not-given-back", _EVENTS, "+= scale * primitive_excess(law, part)",
           "+= 0.0 * scale * primitive_excess(law, part)", "the path beside an event of Tsuji's law is off", k.STEP_EVENTS),
    Mutant("simpson-kuwabara-kono-power", _EVENTS, "primitive_power(law, speed) * h * primitive_power(law, h)",
           "primitive_power(law, speed) * h * h", "the path's excess has the wrong power of the step", k.STEP_EVENTS),
    Mutant("fixed-step-over-touch", _CUBIC, "if away >= 0.0 or back <= 0.0:", "if away >= -1e300:",
           "a touch inside a fixed step is found and then not split at", k.STEP_EVENTS),
    Mutant("jump-read-at-the-cubics-root", _EVENTS, "        if 0.0 < nearer < most:", "        if 0.0 < nearer < -most:",
           "a jump is read where the cubic has its root, not where the overlap vanishes", k.JUMPS_LOCATED),
    Mutant("touching-beads-stay-open", _CUBIC, "if s0 > 0.0 and d1 > 0.0:", "if s0 > 1e300:",
           "beads that touch at rest are pushed together without an event", k.STEP_EVENTS),
    Mutant("later-event-first", _EVENTS, "if root < first:", "if root < 2.0:",
           "of several events in a step a later one is taken first", k.STEP_EVENTS),
)

ERROR_CONTROLLED = (
    Mutant("step-over-a-touch", _BRACKET, "return reach > 0.0", "return reach > 1e300",
           "a contact that closes and opens inside a step with error control is not looked for", k.GRAZING),
    Mutant("touch-bound-from-below", _BRACKET, "reach = max(sign", "reach = min(sign",
           "touches are looked for only where both straight lines meet them", k.STEP_EVENTS),
    Mutant("touch-only-from-open", _BRACKET, "if not (sign * s0 > 0.0 and sign * s1 < 0.0):",
           "if not (sign * s0 > 0.0 and sign * s1 < 0.0 and sign > 0.0):",
           "a contact that lets go and closes again inside a step is not seen", k.STEP_EVENTS),
    Mutant("lands-in-front", _LOCATED, "target = -past if before else past", "target = past if before else -past",
           "steps end in front of the event they were aimed at", k.TOUCHES),
    Mutant("event-not-landed-on", _LOCATED,
           "h = locate_event(method, step, limit, aimed, counts)", "pass",
           "the moment of a contact is as inexact as the dense output", k.TOUCHES),
    Mutant("event-tolerance-loose", _LOCATED, "_OVERLAP_AIM = 1e-15", "_OVERLAP_AIM = 1e-12",
           "steps end a thousand times as far behind their events", k.TOUCHES),
    Mutant("driver-from-dense-output", _CONTROL, "(step.t + x * step.h)", "(step.t + step.h)",
           "the driver stands still while its contact is looked for", k.TOUCHES),
    Mutant("events-not-located", _LOCATED, "        if aimed < 0 or x > 1.0 - _NEAR_END:",
           "        aimed = -1\n        if aimed < 0 or x > 1.0 - _NEAR_END:",
           "a smooth method steps across every contact event", k.DOP853_ORDER),
    Mutant("last-event-of-a-step", _LOCATED, "if root < first and not", "if root <= 2.0 and not",
           "of several contacts that change in a step the last is taken", k.TOUCHES),
    Mutant("rejection-loose", _CONTROL, "        if error <= 1.0:", "        if error <= 1000.0:",
           "steps a thousand times worse than asked for are accepted", k.DOP853_ORDER),
    Mutant("error-unit-loose", _DOP853, "unit = 1.0 / (tolerance * largest)", "unit = 1.0 / (1000.0 * tolerance * largest)",
           "the tolerance is a thousandth of what it says", k.DOP853_ORDER),
    Mutant("error-of-displacements-only", _DOP853, "for row in range(2):\n        largest", "for row in range(1):\n        largest",
           "errors of the velocities are not controlled", k.DOP853_ORDER),
    Mutant("step-too-small-unseen", _CONTROL, "        if is_too_small(0.1 * h, t, trajectory.drive.beta):", "        if is_too_small(2.0 + h, t, trajectory.drive.beta):",
           "a step that shrinks to nothing goes on for ever", ("tests/hard_cases/test_outcomes.py::test_step_too_small",)),
    Mutant("chatter-unseen", _CONTROLLED_RUN, "if events > EVENTS_PER_CONTACT * (bodies - 1):", "if events < 0:",
           "contacts that open and close without end are followed without a word",
           ("tests/hard_cases/test_outcomes.py::test_endless_touches_fail_with_a_sentence",)),
    Mutant("events-of-all-periods", _CONTROLLED_RUN, "t, point, events = 0.0, 0, 0", "t, point = 0.0, 0",
           "a long run is called chatter", k.MANY_PERIODS),
    Mutant("samples-at-step-ends", _CONTROLLED_RUN, "min(1.0, (at - t) / h)", "1.0",
           "samples are taken where a step happens to end", k.DOP853_ORDER),
    Mutant("dense-coefficient", _DOP853, "value = (value + rows[4]) * x", "value = (value + rows[4]) * back",
           "the dense output is wrong inside a step", k.DOP853_ORDER),
    Mutant("dop853-stage-weight", _TABLEAU, "(5, 4): 0.12546768756682242", "(5, 4): 0.12546768766682242",
           "the tenth digit of a stage weight", k.TABLEAU),
    Mutant("dop853-stage-time", _TABLEAU, "    0.6512820512820513,", "    0.6512820512810513,",
           "the twelfth digit of a stage time", k.TABLEAU),
)

CLOCK = (
    Mutant("t-plus-dt", _ENGINE, "self.stepper.evaluate_at_phase(2 * np.pi * self.grid_index / self.grid,",
           "self.stepper.evaluate_at_phase(2 * np.pi * self.elapsed,", "the drive's phase is summed up, not counted", k.CONTINUATION),
    Mutant("phase-of-start-forgotten", _ENGINE, "self.grid_index = round(at) % self.samples * (self.grid // self.samples)",
           "self.grid_index = 0", "a start inside a period begins at phase 0", k.CONTINUATION),
    Mutant("sample-clock-restarts", _ENGINE, "self.grid_index = (self.grid_index + count * (self.grid // self.samples)) % self.grid",
           "self.grid_index = count * (self.grid // self.samples) % self.grid", "a second record begins at another phase", k.CONTINUATION),
    Mutant("time-column-summed", "results/run.py", "time=(index // engine.samples + inside / engine.samples) * scene.period,",
           "time=np.cumsum(np.full(index.size, scene.period / engine.samples)) + (first_sample - 1) * scene.period / engine.samples,",
           "the time of a sample is a sum of steps", k.CLAIMS_TIME),
    Mutant("w-reported-as-velocity", "kernels/samples.py", "samples.velocity[row, i] = dy[i + 1]",
           "samples.velocity[row, i] = y[n + 3 + i]", "velocities are reported without the dashpots' part", k.REFERENCE),
    Mutant("elastic-peak-of-first-contact", _SAMPLING, "elastic_force(slots.chain.stiffness[last], d))",
           "elastic_force(slots.chain.stiffness[0], d))", "the elastic output force is that of a bead, not of the wall",
           k.SIMD_LONG),
    Mutant("peak-between-samples", "kernels/forces/peaks.py", "x = -first / second", "x = first / second",
           "the top of a force is looked for on the wrong side", k.UNLIKE),
)

STEPS = MOTION + FIXED + ERROR_CONTROLLED + CLOCK
