"""Effects in a batch: the values of all members, one member per lane.

In the arguments of a batch, every number of a slot is an array (1, L), and every array of a slot is an array (rows, L);
`integrate/batch.py` makes them. The slot of each effect that batches support has code for `batch_values`, in the
effect's file.
"""

from __future__ import annotations

from ..compiling.dispatch import by_slot


@by_slot
def batch_values(slot):
    """Return the slot with its numbers as vectors over all members, read once for many steps. Effect absent: None."""
    return None
