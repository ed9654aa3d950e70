"""The state in which a motion began, as text in a link.

If several motions are possible, the start decides which one is reached, so a picture cannot be reproduced without its
start. The text is URL-safe base64 of little-endian doubles: drive phase, N displacements [m], N velocities [m/s].
"""

from __future__ import annotations

import base64
import binascii

import numpy as np

from granchain_core import BadInput, Scene, State
from granchain_core.integrate.start import nearest_fraction

#: Beads of the longest chain whose state fits into a link.
MOST_BEADS_IN_LINK = 40


def initial_state_text(start: State | None) -> str:
    """Return the state as text; empty for rest, and for a chain that is too long for a link."""
    if start is None or len(start.displacement) > MOST_BEADS_IN_LINK:
        return ""
    values = np.concatenate([[start.phase], start.displacement, start.velocity]).astype("<f8")
    return base64.urlsafe_b64encode(values.tobytes()).decode().rstrip("=")


def read_initial_state(text: str, scene: Scene) -> State:
    """Read the state of a scene's chain from its text. Raises `BadInput`."""
    try:
        content = base64.b64decode(text + "=" * (-len(text) % 4), altchars=b"-_", validate=True)
        values = np.frombuffer(content, dtype="<f8").astype(float)
    except (binascii.Error, ValueError):
        raise BadInput("The initial state in the link is damaged; the motion starts from rest.") from None
    if len(values) % 2 == 0:  # a phase, and two numbers for each bead
        raise BadInput("The initial state in the link is damaged; the motion starts from rest.")
    if len(values) != 2 * scene.N + 1:
        raise BadInput(f"The initial state in the link has {(len(values) - 1) // 2} beads, but the chain has "
                       f"{scene.N}; the motion starts from rest.")
    phase, displacement, velocity = values[0], values[1:scene.N + 1], values[scene.N + 1:]
    # No contact law is valid for displacements beyond a bead's size or speeds beyond the speed of sound in steel.
    sane = np.isfinite(values).all() and 0.0 <= phase < 1.0 and np.abs(displacement).max() < 1.0
    if not sane or not nearest_fraction(float(phase))[1] or np.abs(velocity).max() > 6000.0:
        raise BadInput("The initial state in the link is impossible for a chain; the motion starts from rest.")
    return State(displacement, velocity, float(phase))
