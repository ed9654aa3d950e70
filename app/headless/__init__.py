"""Figures as PNG and SVG, drawn by a browser without a window, and the search for a browser on the PATH."""
