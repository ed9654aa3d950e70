"""One view a file; a view draws, it decides nothing."""
