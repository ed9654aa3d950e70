"""Monkeypatches of Bokeh and Panel for the whole process.

They put a guard before every request handler, and make a page open faster.
"""
