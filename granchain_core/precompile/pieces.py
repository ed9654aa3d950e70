"""The pieces in which a structure's kernels are compiled ahead of time (warm.py), by name.

The module imports nothing: commands name pieces before they load the compiler.
"""

#: Kernels that follow any steady state: the period of its strobes, and a state in SI.
REGIME_KERNELS = "regime"
#: Checks of a batch, the same for every structure.
CHECK_KERNELS = "checks"
CURVE_KERNELS = "curve"
DOP853_KERNELS = "dop853"
FIXED_STEP_KERNELS = "fixed step"
#: Kernels that any motion needs.
MOTION_KERNELS = (FIXED_STEP_KERNELS, DOP853_KERNELS)
ORBIT_KERNELS = "orbit"
BRANCH_KERNELS = "branch"
OBSERVER_KERNELS = "observer"
ACCURACY_KERNELS = "accuracy"
COST_KERNELS = "cost"
COST_ACCOUNT_KERNELS = "cost account"

#: Roughly how long each piece takes on two cores, where nothing else is compiled [s].
COMPILE_SECONDS = {
    REGIME_KERNELS: 5, CHECK_KERNELS: 10, CURVE_KERNELS: 10, DOP853_KERNELS: 10, FIXED_STEP_KERNELS: 10,
    ORBIT_KERNELS: 15, BRANCH_KERNELS: 40, OBSERVER_KERNELS: 10, ACCURACY_KERNELS: 20, COST_KERNELS: 10,
    COST_ACCOUNT_KERNELS: 10,
}
