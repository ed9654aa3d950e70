"""What was measured: the features the paper's text states, and a user's own data."""

from .features import Feature, stated_features
from .measured import Measured, read_measured_csv

__all__ = ["Feature", "Measured", "read_measured_csv", "stated_features"]
