"""Benchmarks of granchain and other solvers, on the same equations, in one run: `python -m tests.benchmarks`."""
