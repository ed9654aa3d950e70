"""Closed forms of Hertz's theory: the elastic collision of two spheres, and the solitary wave of a chain of spheres.

K is the contact's stiffness, m* the reduced mass of two spheres, m the mass of a bead.
"""

from __future__ import annotations

#: Duration of a collision at relative velocity v, in units of (m*/K)^{2/5} v^{-1/5}.
HERTZ_DURATION = 3.2180655
#: Its peak force, (5/4)^{3/5}, in units of K^{2/5} (m* v²)^{3/5}.
HERTZ_FORCE = 1.1432626
#: Speed of the solitary wave with the largest force F, in units of K^{1/3} F^{1/6} / √m beads per unit of time.
SOLITARY_BY_FORCE = 0.9055158
#: The same with the largest velocity v of a bead, in units of (K/m)^{2/5} v^{1/5}. In Nesterenko's continuum it is
#: (16/25)^{1/5}, since there F = K (5mV²/4K)³ and v = V (5mV²/4K)².
SOLITARY_BY_VELOCITY = 0.9074701
