"""The damping laws for computations that judge granchain_core: their exponents, and structures with each of them."""

from __future__ import annotations

from granchain_core.scene.laws import LAWS

#: Power a of the overlap in the damping force of each law. It is not taken from granchain_core, which is judged by
#: it: tests/kernels/equations, the oracle of random scenes, and tests/numerics/forces.
EXPONENT = {"linear": 0.0, "tsuji": 0.25, "kuwabara-kono": 0.5}
#: Law, tension, foundation, preload: each combination has its own set of kernels.
Structure = tuple[str, str, bool, bool]


def with_every_law(chosen: list[Structure]) -> list[Structure]:
    """The chosen structures, and after them one for each law of the table that is in none of them."""
    named = {law for law, *_ in chosen}
    return [*chosen, *((law, "allowed", False, False) for law in LAWS if law not in named)]
