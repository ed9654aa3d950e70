"""The visitor's own measurement, compared with the model."""
