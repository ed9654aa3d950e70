"""Error against computing time."""
