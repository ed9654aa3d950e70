"""Results of one motion in SI units: the result of a run, the motion over time, and the regime with its evidence."""
