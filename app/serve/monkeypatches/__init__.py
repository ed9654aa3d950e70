"""Monkeypatches of Bokeh and Panel for the whole process, and overrides of Panel's methods: a page opens faster."""
