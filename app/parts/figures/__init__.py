"""Bokeh figures in components: base classes, styles, and the parts of BokehJS that the page uses."""
