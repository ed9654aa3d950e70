"""The pieces in which a structure's kernels are compiled ahead of time (warm.py), by name.

The module imports nothing: commands name pieces before they load the compiler.
"""

CURVE_KERNELS = "curve"
ADAPTIVE_KERNELS = "adaptive"
FIXED_STEP_KERNELS = "fixed step"
#: What any motion needs.
MOTION_KERNELS = (FIXED_STEP_KERNELS, ADAPTIVE_KERNELS)
ORBIT_KERNELS = "orbit"
BRANCH_KERNELS = "branch"
OBSERVER_KERNELS = "observer"
ACCURACY_KERNELS = "accuracy"
COST_KERNELS = "cost"
COST_ACCOUNT_KERNELS = "cost account"
