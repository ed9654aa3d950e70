"""All attractors of one setting, with the share of random starts that lead to each."""

from .attractor import Attractor, Attractors, listing
from .attractors import attractors

__all__ = ["Attractor", "Attractors", "attractors", "listing"]
