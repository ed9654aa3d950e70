"""The pictures in words and in tables, for screen readers and for reading off values."""
