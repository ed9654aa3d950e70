"""Computing for many sessions: worker pools, turns, priorities, shared results."""
