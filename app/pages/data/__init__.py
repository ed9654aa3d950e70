"""The visitor's own measurement beside the model."""
