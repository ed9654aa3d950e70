"""Effects that can be switched on and off, and the cost of each."""
