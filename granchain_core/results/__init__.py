"""Results of one motion: what a run gives back, a recorded motion, the regime."""
