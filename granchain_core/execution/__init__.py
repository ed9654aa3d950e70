"""Execution of long computations: processors, child processes, checkpoints, the stop flag, the time it takes."""
