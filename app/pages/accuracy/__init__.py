"""The page of accuracy: error against computing time."""
