"""DOP853, the Dormand–Prince method of order 8, with located contact events."""
