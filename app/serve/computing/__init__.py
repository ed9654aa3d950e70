"""Computing for many sessions: worker pools, turns, priorities, processor time and shared results."""
