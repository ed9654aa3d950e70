"""Input values: checks, numbers in text, and gaps in a series of samples."""
