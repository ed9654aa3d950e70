"""Many steady states at once: batches of scenes on all cores."""
