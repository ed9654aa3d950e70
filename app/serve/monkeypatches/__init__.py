"""Shortcuts through Bokeh and Panel with which a page opens and changes faster."""
