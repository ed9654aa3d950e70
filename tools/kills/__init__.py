"""Commands killed at random instants: tracebacks, hangs, children left, finished points lost."""
