"""The largest contact forces of a motion, jumps of closing contacts included.

* rk4-split in scalar code: cubics between states, both sides of every event (largest.py).
* rk4 and the naive methods: the same cubics; crossings.py finds the closings.
* SIMD along a short or a long chain: quartics through equal steps (peaks.py), events as in scalar code.
* Batches: peaks.py and crossings.py, called from batch/step.py.
* Methods with error control: their dense output (error_control/force_search.py).
"""
