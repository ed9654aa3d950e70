"""Values from outside: their checks, numbers in text, gaps in a series of samples."""
