"""Monkeypatches of Bokeh and Panel for the whole process, and overrides of Panel's methods.

They put a guard before every handler of requests, and a page opens faster.
"""
