"""The fixture `dashboard`."""

from headless_dashboard import dashboard

__all__ = ["dashboard"]
