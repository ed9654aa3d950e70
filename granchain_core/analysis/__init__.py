"""Analyses (docs/analysis.md): spectrum, Lyapunov spectrum, rotation number, bifurcation diagram, basins; the pulse
of an impact and pass bands (docs/scenes.md).
"""
