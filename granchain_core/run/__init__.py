"""One motion at a stated accuracy: `run`, its budget, its stated error, and the live chain."""
