"""How long computations are executed: processors, child processes, checkpoints, the stop flag, their time."""
