"""The documentation as a site that can be read without a network: `python -m tools.site`."""
