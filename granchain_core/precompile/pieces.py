"""The names of the pieces in which a structure's kernels are compiled ahead of time (warm.py).

The module imports nothing, because commands use these names before they load the compiler.
"""

#: Kernels needed after every steady state: the period of its strobes, and a state in SI units.
REGIME_KERNELS = "regime"
#: The checks of a batch, the same for every structure.
CHECK_KERNELS = "checks"
CURVE_KERNELS = "curve"
DOP853_KERNELS = "dop853"
FIXED_STEP_KERNELS = "fixed step"
#: Kernels of pictures and curves, without the energy account.
MOTION_KERNELS = (FIXED_STEP_KERNELS, DOP853_KERNELS)
#: The default method with the energy account, for `run` and the page's account.
RUN_KERNELS = "run"
#: dop853 with the energy account, for a run to a high accuracy; compiled only when it is needed.
RUN_DOP853_KERNELS = "run with dop853"
ORBIT_KERNELS = "orbit"
BRANCH_KERNELS = "branch"
OBSERVER_KERNELS = "observer"
ACCURACY_KERNELS = "accuracy"
COST_KERNELS = "cost"
COST_ACCOUNT_KERNELS = "cost account"

#: Pieces that a command with batches (curve, map, attractors, basins) compiles in a second process, beside the batch.
BESIDE_A_BATCH = (CHECK_KERNELS, FIXED_STEP_KERNELS)

#: Approximate time that each piece takes on two cores if nothing else is compiled [s], rounded up to five seconds.
COMPILE_SECONDS = {
    REGIME_KERNELS: 5, CHECK_KERNELS: 10, CURVE_KERNELS: 10, DOP853_KERNELS: 10, FIXED_STEP_KERNELS: 10,
    RUN_KERNELS: 10, RUN_DOP853_KERNELS: 15, ORBIT_KERNELS: 15, BRANCH_KERNELS: 40, OBSERVER_KERNELS: 10,
    ACCURACY_KERNELS: 20, COST_KERNELS: 10, COST_ACCOUNT_KERNELS: 10,
}
