"""Warnings about a scene: limits of the model, a missing impurity, a changed κ.

Hertz contact requires small overlaps and elastic steel.
"""

from __future__ import annotations

import itertools

import numpy as np

from .description import Description, reduced

#: Hertz's theory assumes a contact patch that is small compared with the sphere; at an overlap of 1 % of the radius the
#: patch radius √(Rδ/2) is already 7 % of R.
LARGEST_OVERLAP_FRACTION = 0.01
#: Spheres with ν = 0.3 begin to yield, below the surface, at a peak pressure of 1.6 Y (Johnson, Contact
#: Mechanics, 1985, section 6.1).
ONSET_OF_YIELD = 1.6
#: Yield stress of hardened bearing steel (AISI 52100) [Pa]: a third of the hardness (Tabor, The Hardness of Metals,
#: 1951), 60 HRC being 697 HV, that is 6.84 GPa (ASTM E140). Softer steel yields sooner.
YIELD_STRESS = 2.28e9


def contact_geometry(scene: Description) -> tuple[np.ndarray, np.ndarray]:
    """Return E* [Pa] and R* [m] of every contact (N+1,); the driver is a bead like bead 1.

    The walls "same-material" and "rigid" are flat, and a rigid wall has no compliance of its own. A wall that is given
    by a number counts as a bead.
    """
    beads = (scene.beads[0], *scene.beads, scene.beads[-1])
    modulus, radius = np.array([reduced(left, right) for left, right in itertools.pairwise(beads)]).T.copy()
    if scene.wall in ("same-material", "rigid"):
        radius[-1] = beads[-1].radius
    if scene.wall == "rigid":
        modulus[-1] = beads[-1].young / (1 - beads[-1].poisson**2)
    return modulus, radius


def peak_pressures(scene: Description, overlaps: np.ndarray) -> np.ndarray:
    """Return Hertz's peak pressures p0 = (1/π)(6 F E*²/R*²)^{1/3} = (2E*/π)√(δ/R*) at these overlaps (N+1,)."""
    modulus, radius = contact_geometry(scene)
    return 2.0 * modulus / np.pi * np.sqrt(np.maximum(overlaps, 0.0) / radius)


def overlap_warnings(scene: Description, largest_overlap: float | np.ndarray) -> list[str]:
    """Return warnings for a chain whose contacts reached these overlaps [m], one number or one for each contact."""
    overlaps = np.broadcast_to(np.asarray(largest_overlap, dtype=float), scene.N + 1)
    warnings, largest = [], float(overlaps.max())
    fraction = largest / min(b.radius for b in scene.beads)
    if fraction > LARGEST_OVERLAP_FRACTION:
        warnings.append(f"The largest overlap, {largest:.2e} m, is {100 * fraction:.1f} % of a bead's radius; "
                     f"Hertz's law holds below about {100 * LARGEST_OVERLAP_FRACTION:.0f} %.")
    pressures = peak_pressures(scene, overlaps)
    worst = int(pressures.argmax())
    if pressures[worst] > ONSET_OF_YIELD * YIELD_STRESS:
        warnings.append(f"The peak pressure in contact {worst}, {1e-9 * pressures[worst]:.1f} GPa, is above "
                     f"{1e-9 * ONSET_OF_YIELD * YIELD_STRESS:.1f} GPa, where hardened bearing steel begins to yield; "
                     f"beyond it the contact is not elastic.")
    return warnings


def warnings(scene: Description) -> list[str]:
    """Return warnings that need no run: the drive amplitude and the preload alone overlap the beads too far."""
    listed = overlap_warnings(scene, np.maximum(scene.drive_amplitude, scene.static_overlap()))
    return [*listed, *([missing] if (missing := missing_impurity(scene)) else [])]


def missing_impurity(scene: Description) -> str:
    """Return a warning if the impurity's place is beyond the last bead; otherwise empty."""
    if scene.impurity == 1.0 or scene.site <= scene.N:
        return ""
    return (f"The impurity's place, bead {scene.site}, is not in this chain of {scene.N} beads, so there is no "
            f"impurity; the nearest valid value is {scene.N}.")


def moved_kappa(before: Description, after: Description) -> str:
    """State κ before A₀ changed at constant k; empty if A₀ did not change, k did, or there is no foundation."""
    if after.A0 == before.A0 or after.k != before.k or after.k == 0.0:
        return ""
    return f"κ was {before.kappa:.4g} before A₀ changed at constant k"
