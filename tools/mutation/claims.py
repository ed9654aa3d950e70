"""Mutants of the claims: regimes, settling, stated errors, failures, restarts, budgets, observers, compiler."""

from __future__ import annotations

from granchain_core.kernels.compiling.jit import FAST_MATH

from . import killers as k
from .mutant import Mutant

_SECTION, _REGIME, _RECORDING = "kernels/strobes/periodicity.py", "steady/regime_criteria.py", "steady/settling/recording.py"
_RUN, _STATED, _METHODS = "runs/to_accuracy.py", "integrate/stated.py", "integrate/methods.py"

STEADY = (
    Mutant("change-taken-for-distance", _SECTION, "distance = recent * contraction / (1.0 - contraction)", "distance = recent",
           "a slow approach is called settled", k.REGIMES),
    Mutant("faster-half-counts", _SECTION, "contraction = max(early, late)", "contraction = min(early, late)",
           "the decay is taken from the half of the record in which it is faster", k.PERIODICITY),
    Mutant("lost-in-rounding-is-there", _REGIME, "distance = max(distance, rounding * contraction / (1.0 - contraction))", "distance = 0.0",
           "a change lost in rounding counts as no distance at all", k.CRITERIA),
    Mutant("longest-period-told", _SECTION, "if largest <= negligible:\n            return q",
           "if largest <= negligible:\n            return n", "an orbit of period 1 is reported as one of period 2",
           k.PERIODICITY),
    Mutant("any-growth-is-chaos", _REGIME, "return mean > max(STANDARD_ERRORS * error, _BOUNDED_GROWTH / periods)", "return mean > 0.0",
           "an exponent within its error is called chaos", k.CRITERIA),
    Mutant("creeping-is-quasi-periodic", _REGIME, "if _neither_converges_nor_departs(windows) and", "if",
           "a slow approach with an exponent near zero is called quasi-periodic", k.CRITERIA),
    Mutant("bias-of-a-torus-is-not-excluded", _REGIME, "return periods < _periods_of_comparison(mean, error) <= _LONGEST_COMPARISON", "return False",
           "a slow approach, or weak chaos, is called quasi-periodic although its exponent is known not to be zero", k.TORUS_BIAS),
    Mutant("drift-is-quasi-periodic", _REGIME, " and distance < limit else", " else",
           "a section that never returns is called a closed curve", k.CRITERIA),
    Mutant("settled-error-without-distance", _RECORDING, "regime, integration + distance, cost,", "regime, 0.0 * integration + distance, cost,",
           "a settled picture states no error of its integration", k.SETTLED),
    Mutant("settled-error-not-amplified", "steady/orbit_errors.py", "typical_error(finer)) / (1.0 - contraction)", "typical_error(finer))",
           "an error of the map is taken for that of its fixed point", k.FIXED_POINT),
    Mutant("relaxed-by-change", "steady/settling/refine_orbit.py", "unproved, bound = None, change * max(1.0, contraction / (1.0 - contraction))", "unproved, bound = None, change",
           "the converged orbit is left too early", k.RELAXING),
    Mutant("neighbour-not-pulled-back", "steady/lyapunov.py", "offset *= _DISTANCE / distance", "offset *= 1.0",
           "the exponent is that of a distance that has long been large", k.LYAPUNOV),
)

_WINDING = "analysis/winding.py"
ROTATION = (
    Mutant("rotation-equal-weights", "analysis/birkhoff.py", "bump = np.exp(-1.0 / (t * (1.0 - t)))", "bump = np.ones(count)",
           "the average of a torus converges as 1/P", k.ROTATION),
    Mutant("rotation-halves-not-compared", _WINDING, "error = max(_STATED * max(*errors, convergence[-1, 2]), _ROUNDING)", "error = _ROUNDING",
           "the error of an average is always rounding", k.ROTATION),
    Mutant("rotation-near-any-fraction", _WINDING, " * states < fewest:", " * states < 0.0:",
           "a record that does not fill the curve has a rotation number", k.ROTATION),
    Mutant("rotation-of-another-line", _WINDING, "abs(excess) > AT_MULTIPLE / len(states) or ", "",
           "the angle of a stronger line is taken for that of a weak one", k.ROTATION),
    Mutant("rotation-of-one-curve", _WINDING, "if curves == 1:", "if curves >= 1:",
           "curves that are visited in turn are taken for a single one", k.ROTATION),
    Mutant("rotation-of-a-multiple", _WINDING, "round(multiple * near - advance)) / multiple", "round(multiple * near - advance))",
           "an angle that turns twice along the curve is taken for the curve's own", k.ROTATION),
    Mutant("rotation-of-these-steps", "analysis/rotation_number.py", "return shorter, IRREGULAR * folded(longer.value - shorter.value)", "return shorter, 0.0",
           "the time steps have no stated error", k.ROTATION_STEPS),
)

STATED = (
    Mutant("error-factor", "integrate/safety_factors.py", "\nREGULAR = 1.5", "\nREGULAR = 0.015",
           "the stated error is a hundredth of the observed one", k.HONESTY),
    Mutant("same-steps-compared", _METHODS,
           "while finer.steps_per_period(scaled, samples) == self.steps_per_period(scaled, samples):",
           "while finer.steps_per_period(scaled, samples) < self.steps_per_period(scaled, samples):",
           "two computations with the same steps are compared", k.SAME_STEPS),
    Mutant("error-without-floor", _STATED, "np.maximum(least_errors, self.rounding))", "self.rounding)",
           "an error of exactly zero is stated", k.SAME_STEPS),
    Mutant("error-of-last-sample", _STATED, "np.abs(first - second).max()) / largest",
           "np.abs(first - second)[0].max()) / largest",
           "the first sample's difference is stated for all", k.HONESTY),
    Mutant("done-too-early", _RUN, "if error <= scene.accuracy:\n", "if error <= 1e4 * scene.accuracy:\n",
           "a run is called done that is not as accurate as asked for",
           ("tests/hard_cases/test_outcomes.py", "-k", "accuracy_not_reached or files_carry or not_begun")),
    Mutant("finer-is-the-same", _METHODS, "min(max(self.tolerance / 64.0, _SMALLEST_TOLERANCE), self.tolerance / 8.0)",
           "self.tolerance",
           "the finer of two computations is the same as the other", k.HONESTY),
    Mutant("sample-index-without-phase", _RUN, "first = periods * samples + round(begin.phase * samples)", "first = periods * samples",
           "time and driver of a run from a given phase are those of phase 0", k.CONTINUATION),
    Mutant("peaks-of-the-transient", _RUN, "    engine.begin_record()\n", "", "largest forces include those of the discarded periods",
           k.CLAIMS_RUN),
    Mutant("energy-residual-of-work", "results/run.py", "np.abs(work - lost - stored).max()", "np.abs(work - lost).max()",
           "the energy account does not include the stored energy", k.ENERGY_PLAIN),
)

FAILING = (
    Mutant("failed-step-of-its-end", "integrate/fixed.py", "if b), 0), low % steps", "if b), 0), high % steps",
           "the step after the one that failed is named", ("tests/hard_cases/test_outcomes.py", "-k", "middle_of_a_long_call")),
    Mutant("failed-time-since-call", "integrate/engine.py", "Failure(status, periods=self.elapsed + done,", "Failure(status, periods=done,",
           "the time of a failure is counted from the present call", k.FAILURES_T),
    Mutant("nan-of-velocity-unseen", "kernels/samples.py", "if not (np.isfinite(y[i]) and np.isfinite(y[bodies + i])):",
           "if not np.isfinite(y[i]):", "a NaN velocity is seen only once it has reached a displacement, in another bead",
           k.FAILURES_W),
    Mutant("checkpoint-without-scale", "integrate/checkpoint.py", "work.next_step[0], work.scale[:] = kept.control[0], kept.control[1:]",
           "work.next_step[0] = kept.control[0]", "error control continues with another unit after a restart", k.CHECKPOINTS),
    Mutant("checkpoint-without-next-step", "integrate/checkpoint.py", "work.next_step[0], work.scale[:] = kept.control[0], kept.control[1:]",
           "work.scale[:] = kept.control[1:]", "error control continues with another step after a restart", k.CHECKPOINTS),
    Mutant("checkpoint-at-phase-0", "integrate/checkpoint.py", "engine.grid_index, engine.elapsed = kept.grid_index, kept.elapsed",
           "engine.elapsed = kept.elapsed", "a run that was cut inside a period continues at the period's start", k.CHECKPOINTS),
    Mutant("budget-of-one-computation", "runs/budget.py", "steps, seconds = steps * repetition_factor, seconds * repetition_factor", "steps, seconds = 0.25 * steps, 0.25 * seconds",
           "the estimate of a run is a fraction of it", ("tests/hard_cases/test_outcomes.py", "-k", "within_a_factor_of_two and (knobs0 or knobs3 or knobs6)")),
    Mutant("budget-not-kept", "runs/budget.py", "if estimate.seconds <= budget:", "if estimate.seconds <= 1e30 * budget:",
           "a run of years is started", ("tests/hard_cases/test_outcomes.py", "-k", "command_line_refuses or offered_number_of_periods")),
)

OBSERVED = (
    Mutant("force-overshoots", "observers/record.py", "from scipy.interpolate import PchipInterpolator  #",
           "from scipy.interpolate import CubicSpline as PchipInterpolator  #",
           "between samples a measured force is above both, or below 0", k.SAMPLING),
    Mutant("force-in-seconds", "observers/force_driven_chain.py", "/ scales.phi ** np.arange(4)", "/ scales.phi ** np.zeros(4)",
           "the slopes of a measured force are not scaled", k.SAMPLING),
    Mutant("loss-between-samples", "observers/observe.py", "(IRREGULAR * np.maximum(", "(1e-3 * IRREGULAR * np.maximum(",
           "the error between samples is stated a thousand times too small", k.SAMPLING),
)


def _flags(*more: str) -> str:
    """Return the fast-math flags as jit.py writes them, with `more` added."""
    return "(" + ", ".join(f'"{flag}"' for flag in (*FAST_MATH, *more)) + ")"


COMPILED = (
    Mutant("fastmath", "kernels/compiling/jit.py", '{"fastmath": set(FAST_MATH)', '{"fastmath": True',
           "the compiler may assume that there is no NaN and no infinity", k.FASTMATH, optimised=True),
    Mutant("fastmath-in-vectors", "kernels/compiling/jit.py", f"FAST_MATH = {_flags()}", 'FAST_MATH = ("fast",)',
           "operations on vectors, too, may assume that there is no NaN and no infinity", k.VECTORS, optimised=True),
    Mutant("fastmath-nnan", "kernels/compiling/jit.py", _flags(), _flags("nnan"),
           "the compiler may assume that there is no NaN", k.FASTMATH, optimised=True),
    Mutant("fastmath-ninf", "kernels/compiling/jit.py", _flags(), _flags("ninf"),
           "the compiler may assume that there is no infinity", k.FASTMATH, optimised=True),
)

CLAIMS = STEADY + ROTATION + STATED + FAILING + OBSERVED + COMPILED
