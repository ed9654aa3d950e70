"""Results of one motion in SI: what a run gives back, the motion over time, the regime with its evidence."""
