"""The largest contact forces of a motion, jumps of closing contacts included.

* rk4-split in scalar code: cubics between states, and both sides of every event (largest.py).
* rk4 and the naive methods: the same cubics; crossings.py finds the closings.
* SIMD along a short or a long chain: quartics through equal steps (peaks.py), and events as in scalar code.
* Batches: peaks.py and crossings.py, called from batch/step.py.
* Methods with error control: their dense output (error_control/force_search.py).

Functions that update the largest forces, and their input:

=========================== ====================================================
function                    input
=========================== ====================================================
update_largest              one value
update_maximum              a cubic over a step
update_forces               a state at which no contact changes
update_forces_at_event      a state and one side of an event
update_forces_across_event  both sides of an event
update_end_forces_at_event  overlaps and rates of the end contacts at an event
record_closing(s)           the jumps of contacts that close
update_peak                 the last five values after equal steps
update_batch_peak           the same in all lanes of a batch
update_block_peak(s)        the steps of a block of a short chain
update_jump(s)              overlap and rate before and after a step of a batch
=========================== ====================================================
"""
