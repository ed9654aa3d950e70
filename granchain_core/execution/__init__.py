"""Execution of long computations: processors, child processes, checkpoints, stop flag and timing."""
