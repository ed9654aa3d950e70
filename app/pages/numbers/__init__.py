"""The pictures in words and in tables, for who cannot see them or wants to read a value."""
