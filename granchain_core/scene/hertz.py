"""The elastic collision of two spheres by Hertz's theory; K is the contact's stiffness, m* the reduced mass."""

from __future__ import annotations

#: Duration of a collision at relative velocity v, in units of (m*/K)^{2/5} v^{-1/5}.
HERTZ_DURATION = 3.2180655
#: Its peak force, (5/4)^{3/5}, in units of K^{2/5} (m* v²)^{3/5}.
HERTZ_FORCE = 1.1432626
