"""Execution of long computations: processors, child processes, checkpoints, the stop flag, their time."""
