"""The documentation as a site that is read without a network: `python -m tools.site`."""
