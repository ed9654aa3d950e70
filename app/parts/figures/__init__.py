"""Bokeh figures in components: base classes, styles, and what the page uses of BokehJS."""
