"""Batches: many steady states at once, on all cores.

A batch integrates several chains side by side, one in each lane of a SIMD vector. When the regime of one chain is
decided, the next chain takes over its lane. The terms of this package:

start        a scene that is to be settled, with the state in which it starts (`Start` in job.py)
job          a start that is being settled, in a lane or waiting for one (`BatchJob`)
lane         one place in the vectors of the batch
member       the scene in a lane, as kernels and `Batch` (integrate/batch.py) number it
neighbour    the neighbouring trajectory of a member whose Lyapunov exponent is measured; it takes a lane of its own
stage        the run that a job is in or waits for (`Stage`): *coarse*, with the fixed-step method's default step, until
             strobes show a period; *fine*, with shorter steps on the periodic orbit, for its error; *exponent*, along
             with a neighbour
due          of a member: it needs a decision that only Python makes, so `Batch.run` returns it
draft        the coarse runs alone, over few periods, for a first look at a curve
undecided    of a result: the batch could not decide the regime, so the chain is settled alone (settling/)

docs/design.md ("A curve from the call to the last point") describes a point's way through these stages.
"""
