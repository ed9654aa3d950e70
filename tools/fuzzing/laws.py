"""The damping laws for computations that judge granchain_core: their exponents, and structures with each law."""

from __future__ import annotations

from granchain_core.scene.laws import LAWS

#: Power a of the overlap in the damping force of each law. It is not imported from granchain_core, because it serves to
#: judge it: in tests/kernels/equations, in the oracle of random scenes, and in tests/numerics/forces.
EXPONENT = {"linear": 0.0, "tsuji": 0.25, "kuwabara-kono": 0.5}
#: Law, tension, foundation, preload: each combination has its own set of kernels.
Structure = tuple[str, str, bool, bool]


def with_every_law(chosen: list[Structure]) -> list[Structure]:
    """Return the chosen structures, followed by one for each law of the table that none of them has."""
    named = {law for law, *_ in chosen}
    return [*chosen, *((law, "allowed", False, False) for law in LAWS if law not in named)]
