"""Monkeypatches of Bokeh and Panel for the whole process, and overrides of Panel's methods.

They put a guard before every request handler, and make a page open faster.
"""
