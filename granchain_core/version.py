"""The version that result files carry."""

__version__ = "0.1.0"
