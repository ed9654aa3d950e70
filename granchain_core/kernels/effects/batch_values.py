"""Effects in a batch: the values of all members, one member in each lane.

In the arguments of a batch, every number of a slot is an array (1, L), and every array of a slot one of (rows, L).
`integrate/batch.py` makes them. A slot of an effect that batches know has code for `batch_values` (in the effect's
file).
"""

from __future__ import annotations

from ..compiling.dispatch import by_slot


@by_slot
def batch_values(slot):
    """The slot with its numbers as vectors of all members, read once for many steps. Effect absent: None."""
    return None
