"""Computing for many visitors: queues, turns, priorities, shared results."""
