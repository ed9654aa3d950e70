"""DOP853 along a short chain, in a transformed time next to contact events."""
