"""Hertz's law F = K δ^p: the exponent, and closed forms of the elastic collision and of a chain's solitary wave.

K is the contact stiffness, m* the reduced mass of two spheres, m the mass of a bead.
"""

from __future__ import annotations

#: The exponent p. Kernels write the law as K δ √δ (docs/design.md lists the places).
EXPONENT = 1.5
#: The overlap as a power of the force, 1/p.
OVERLAP_POWER = 1.0 / EXPONENT
#: A contact's natural frequency as a power of the overlap, (p − 1)/2: (A0, f) → (sA0, s^{1/4} f) leaves the scaled
#: motion unchanged.
RATE_POWER = (EXPONENT - 1.0) / 2.0
#: Duration of a collision at relative velocity v, in units of (m*/K)^{2/5} v^{-1/5}.
HERTZ_DURATION = 3.2180655
#: Peak force of a collision, (5/4)^{3/5}, in units of K^{2/5} (m* v²)^{3/5}.
HERTZ_FORCE = 1.1432626
#: Speed of the solitary wave with peak force F, in units of K^{1/3} F^{1/6} / √m beads per unit of time.
SOLITARY_BY_FORCE = 0.9055158
#: Speed of the solitary wave with peak bead velocity v, in units of (K/m)^{2/5} v^{1/5}. In Nesterenko's continuum, it
#: is (16/25)^{1/5}, since there F = K (5mV²/4K)³ and v = V (5mV²/4K)².
SOLITARY_BY_VELOCITY = 0.9074701
