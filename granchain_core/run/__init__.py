"""One motion at a stated accuracy: `run`, its budget, its error estimate, and the live chain."""
