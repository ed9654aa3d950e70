"""What was measured: the features the paper's text states, and a user's own data."""

from .features import Feature, stated_features
from .measured import Measured, read_measured_csv
from .series import Series, Shaker, read_experiment

__all__ = ["Feature", "Measured", "Series", "Shaker", "read_experiment", "read_measured_csv", "stated_features"]
