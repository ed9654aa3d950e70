"""Input from outside: checks of values, numbers in text, gaps in a series of samples."""
