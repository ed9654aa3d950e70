"""Commands killed at random instants: tracebacks, hangs, leftover children, lost points."""
