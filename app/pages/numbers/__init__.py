"""The pictures in sentences and tables, for screen readers and for reading off values."""
