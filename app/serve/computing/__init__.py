"""Computing for many sessions: worker pools, turns, priorities, processor time, shared results."""
