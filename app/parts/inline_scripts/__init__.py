"""The scripts that are written into the page and run before any module."""
