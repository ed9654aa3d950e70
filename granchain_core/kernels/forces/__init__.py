"""The largest contact forces of a motion, jumps of closing contacts included.

rk4-split, one number at a time: cubics between states, events on both sides (largest.py). rk4 and the naive methods:
the same, and crossings.py for closings. Short and long chains: quartics through equal steps (peaks.py), events as
above. Batch: peaks.py and crossings.py, called from batch/step.py. dop853: its dense output (dop853/force_search.py).
"""
