"""Where the model itself stops: Hertz contact needs small overlaps and elastic steel."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .description import Scene

#: Hertz's theory takes the contact patch as small against the sphere; at an overlap of 1 % of the radius the
#: patch radius √(Rδ/2) is already 7 % of R.
LARGEST_OVERLAP_FRACTION = 0.01


def overlap_warnings(scene: Scene, largest_overlap: float) -> list[str]:
    """Sentences for a chain whose contacts reached `largest_overlap` [m]."""
    radius = min(b.radius for b in scene.beads)
    fraction = largest_overlap / radius
    if fraction <= LARGEST_OVERLAP_FRACTION:
        return []
    return [f"The largest overlap, {largest_overlap:.2e} m, is {100 * fraction:.1f} % of a bead's radius; "
            f"Hertz's law holds below about {100 * LARGEST_OVERLAP_FRACTION:.0f} %."]


def warnings(scene: Scene) -> list[str]:
    """Sentences known before anything is run: the drive amplitude and the preload already overlap the beads."""
    return overlap_warnings(scene, max(scene.A0, float(scene.static_overlap().max())))
