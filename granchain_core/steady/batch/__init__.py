"""Batches: many steady states at once, on all cores.

A batch integrates several chains side by side, one in each lane of a SIMD vector. When the regime of one chain is
decided, the next chain takes over its lane. The words of this package:

start        a scene that is to be settled, with the state in which it begins (`Start` in job.py)
job          a start that is being settled, in a lane or waiting for one (`BatchJob`)
lane         one place in the vectors of the batch
member       the scene in a lane, as kernels and `Batch` (integrate/batch.py) number it
neighbour    the neighbouring trajectory of a member whose Lyapunov exponent is measured; it takes a lane of its own
stage        what a job runs or waits to run (`Stage`): *coarse*, the fixed-step method's default step, until strobes
             show a period; *fine*, shorter steps on the periodic orbit, for its error; *exponent*, beside a neighbour
due          of a member: it needs a decision that only Python makes, and `Batch.run` returns it
draft        the coarse runs alone, over few periods, for a first look at a curve
undecided    of a result: the batch could not decide the regime, and the chain is settled alone (settling/)

docs/design.md ("A curve from the call to the last point") has the way of a point through these stages.
"""
