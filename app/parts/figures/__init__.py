"""Bokeh figures in components: base classes, style, and what the browser does with them."""
