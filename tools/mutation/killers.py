"""The tests that should notice a mutant, those that compile least, as arguments for pytest."""

from __future__ import annotations

#: The right-hand side against the (u, v) equations of the paper, NaN, equilibrium, v to w and back; the same for
#: unequal beads; NaN in every member; values that are not finite.
MOTION = ("tests/kernels/equations/test_motion.py",)
UNEQUAL = ("tests/kernels/effects/test_scaled_numbers.py", "tests/kernels/effects/test_given_force.py",
           "tests/kernels/error_control/test_force_kinks.py")
VECTORS = ("tests/kernels/simd/test_vector_nan.py",)
FAILURES_W = ("tests/integrate/test_not_finite.py", "-k", "first_bead")
FASTMATH = ("tests/integrate/test_not_finite.py", "tests/kernels/equations/test_motion.py", "-k",
            "not_finite or not_a_number or a_nan_in_a_bead and none")

#: The energy account of one combination of effects; samples against the stored extended-precision solution.
ENERGY = ("tests/physics/test_energy.py", "-k", "account_closes and linear-allowed-0.002-0.0")
ENERGY_PLAIN = ("tests/physics/test_energy.py", "-k", "account_closes and linear-allowed-0.0-0.0")
ENERGY_WORK = ("tests/physics/test_energy.py", "-k", "work_and_loss and linear-allowed-0.0-0.0")
ON_THE_WAY = ("tests/physics/test_work_on_the_way.py",)
REFERENCE = ("tests/physics/test_reference.py::test_displacements_agree_to_1e_8_at_every_sample[sec2-340]",)

#: Events inside one fixed step, run by Python; a complete touch inside one step.
STEP_EVENTS = ("tests/kernels/rk4/test_step_events.py",)
CUBIC = ("tests/kernels/test_contact_cubic.py",)
EVENT_PREDICATES = ("tests/kernels/test_event_predicates.py",)
JUMPS_LOCATED = ("tests/kernels/forces/test_largest_forces.py::test_a_jump_is_read_where_the_overlap_vanishes",)
STEP_TOUCH = ("tests/numerics/test_fixed_step_touches.py", "-k", "1e-06-True")

#: Brief touches and steps with error control.
TOUCHES = ("tests/numerics/test_touches.py", "-k", "none_is_invented and True or moment_of_a_touch or two_touches")
GRAZING = ("tests/numerics/test_events.py", "-k", "brief_touch")

#: Coefficients and orders of convergence.
TABLEAU = ("tests/kernels/dop853/test_tableau.py",)
RK4_ORDER = ("tests/numerics/test_orders.py", "-k", "has_its_order and rk4-closed")
DOP853_ORDER = ("tests/numerics/test_orders.py", "-k", "dop853-none or follows_its_tolerance and linear")
CUT_ENERGY = ("tests/physics/test_energy.py", "-k", "account_closes and linear-cut-0.0-0.0")
CUT_ORDER = ("tests/numerics/test_orders.py", "-k", "has_its_order and dop853-cut")
FORCE_FREE = ("tests/numerics/test_force_free.py",)
FORCE_FREE_ENERGY = ("tests/numerics/test_force_free.py", "tests/physics/test_energy.py", "-k",
                     "force_free or account_closes and (linear-cut or kuwabara-kono-cut) or cut_contacts_closes")
CUT_SYMMETRY = ("tests/hard_cases/test_cases.py", "-k", "case_holds and several")

#: A short chain in a vector, and a long one in blocks, against the scalar method.
SIMD = ("tests/kernels/simd/test_simd.py", "-k", "along_the_chain and (tsuji-rigid or tsuji-pressed)")
SIMD_LAWS = ("tests/kernels/simd/test_simd.py", "-k", "along_the_chain and (tsuji-pressed or kuwabara-kono-rigid)")
SIMD_PLAIN = ("tests/kernels/simd/test_simd.py", "-k", "along_the_chain and plain")
SIMD_LONG = ("tests/kernels/simd/test_simd.py", "-k", "along_the_chain and hundred")
SIMD_LONG_FOUNDED = ("tests/kernels/simd/test_simd.py", "-k", "along_the_chain and long-founded")
SIMD_LONG_PRESSED = ("tests/kernels/simd/test_simd.py", "-k", "along_the_chain and long-pressed")

#: A short chain in a transformed time against the method that ends its steps at events; brief touches; marks of slots.
ROOT_ROUNDING = ("tests/kernels/dop853_root/test_events_inside.py",)
ROOT = ("tests/numerics/test_methods_agree.py", "-k", "linear-dop853-root")
ROOT_FOUNDED = ("tests/numerics/test_methods_agree.py", "-k", "foundation-dop853-root")
ROOT_PRESSED = ("tests/numerics/test_methods_agree.py", "-k", "preload-dop853-root")
ROOT_TSUJI = ("tests/numerics/test_methods_agree.py", "-k", "tsuji-dop853-root")
ROOT_FORCES = ("tests/kernels/dop853_root/test_dop853_root.py", "-k", "motion_and_forces and events")
ROOT_TOUCH = ("tests/kernels/dop853_root/test_dop853_root.py", "-k", "brief_touch")
MARKS = ("tests/kernels/simd/test_marks.py",)

#: Eight chains at once: their order, their forces, unequal beads, the drive phase, their checks.
BATCH = ("tests/kernels/batch/test_batch_steps.py", "-k", "order_three and sec2")
BATCH_ONE = ("tests/kernels/batch/test_batch_steps.py", "-k", "order_three and one")
BATCH_KK = ("tests/kernels/batch/test_batch_steps.py", "-k", "order_three and Kuwabara")
BATCH_PRESSED = ("tests/kernels/batch/test_batch_steps.py", "-k", "order_three and pressed")
BATCH_FOUNDED = ("tests/kernels/batch/test_batch_steps.py", "-k", "order_three and founded")
BATCH_FORCES = ("tests/kernels/batch/test_batch_steps.py", "-k", "largest_forces and sec2")
UNEQUAL_BATCH = ("tests/kernels/batch/test_unequal_beads.py", "-k", "unequal_beads")
BATCH_PHASE = ("tests/integrate/test_continuation.py", "-k", "phase_of_a_batch")
BATCH_CHECKS = ("tests/kernels/batch/test_checks.py",)
REFILL = ("tests/kernels/batch/test_refill.py",)
NEIGHBOURS = ("tests/steady/test_batch_neighbours.py", "-k", "pair")
LYAPUNOV = ("tests/steady/test_lyapunov.py", "-k", "chaotic_chain")
ROTATION = ("tests/analysis/test_rotation_number.py", "-k", "circle_map or noise or short or in_turn or twice")
ROTATION_STEPS = ("tests/analysis/test_rotation_number_of_chains.py", "-k", "finer_steps")

#: Tangents: their columns, and their determinant, which does not see a missing saltation.
ROUTES = ("tests/orbits/test_tangents.py", "-k", "missing_saltation or one_derivative and changes4")
COLUMNS = ("tests/orbits/test_orbits.py", "-k", "every_column and linear or liouvilles and linear")
LIOUVILLE = ("tests/orbits/test_orbits.py", "-k", "liouvilles and linear")
FOUNDED_COLUMNS = ("tests/orbits/test_orbits.py", "-k", "every_column and founded")
MONODROMY = ("tests/orbits/test_multipliers.py", "-k", "sec2-340 or dashpot")
MONODROMY_TSUJI = ("tests/orbits/test_multipliers.py", "-k", "tsuji")
SAME_EVENTS = ("tests/orbits/test_tangents.py", "-k", "same_events")
TWO_PERIODS = ("tests/orbits/test_orbits.py", "-k", "twice_its_period")
FLOW_TOUCH = ("tests/kernels/flow/test_flow_touches.py",)
FLOW_ROUNDING = ("tests/kernels/flow/test_flow_touches.py", "-k", "by_rounding")
ORBIT_CLAIMS = ("tests/orbits/test_orbit_claims.py",)
NORMAL_FORMS = ("tests/orbits/test_normal_forms.py",)
CRITICALITY = ("tests/orbits/test_criticality.py", "-k", "order")

#: Observers.
OBSERVER_ORBIT = ("tests/observers/test_twin.py", "-k", "multipliers_are_finite")
TWIN = ("tests/observers/test_twin.py", "-k", "starts_where")
SAMPLING = ("tests/observers/test_sampling.py", "-k", "follows_its_chain and smooth or monotone")

#: Time, restarts, failures.
CONTINUATION = ("tests/integrate/test_continuation.py", "-k", "not stop_flag")
CHECKPOINTS = ("tests/integrate/test_checkpoints.py",)
FAILURES_T = ("tests/integrate/test_not_finite.py", "-k", "counts_from_the_start")
STIFFEST = ("tests/integrate/test_failures.py", "-k", "stiffest")

#: Claims about a motion.
HONESTY = ("tests/numerics/test_stated_errors.py", "-k", "not curve")
SAME_STEPS = ("tests/numerics/test_stated_errors.py", "-k", "same_steps")
REGIMES = ("tests/kernels/strobes/test_periodicity.py", "-k", "linear_map or slow_approach or roots_of_one or closed_curve")
SETTLED = ("tests/steady/test_regimes.py", "-k", "section_2_from_rest")
PERIODICITY = ("tests/kernels/strobes/test_periodicity.py", "-k", "two_halves or shortest_period")
CRITERIA = ("tests/steady/test_regime_criteria.py",)
TORUS_BIAS = ("tests/steady/test_jobs_in_batch.py", "-k", "bias_of_a_torus")
CLAIMS_TIME = ("tests/runs/test_sample_times.py",)
CLAIMS_RUN = ("tests/runs/test_peaks.py", "-k", "recorded_periods or largest_elastic")
FIXED_POINT = ("tests/steady/test_orbit_errors.py", "-k", "fixed_point")
RELAXING = ("tests/steady/test_refine_orbit.py",)
