"""Basins of a plane: each start's own long run ends on the attractor that its cell names."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import BadInput, State, attractors, basins, scene
from granchain_core.steady.settling.single_chain import steady_state
from granchain_core.stop import Stop

#: Two attractors with shares near a half (docs/diagram.md).
SHARED = scene("sec2").evolve(f=1641.0, A0=0.53e-6)


def test_each_start_ends_where_its_cell_says() -> None:
    u, v = np.array([-4e-7, 0.0, 4e-7]), np.array([-4e-3, 0.0, 4e-3])
    found = basins(SHARED, ("u1", u), ("v11", v))
    assert found.number.shape == (3, 3) and found.shares.sum() == pytest.approx(1.0)
    for row, column in ((0, 0), (1, 1), (2, 1)):
        state = np.zeros((2, 11))
        state[0, 0], state[1, 10] = u[column], v[row]
        alone = steady_state(SHARED, State(*state), Stop())
        named = found.attractors[found.number[row, column]]
        assert (alone.regime.name, alone.regime.period) == (named.regime.name, named.regime.period)


def test_the_attractors_are_among_those_of_random_starts() -> None:
    chain = scene("sec2").evolve(N=2, f=2000.0)
    found, all_of_them = basins(chain, ("u1", [0.0, 2e-7]), ("u2", [0.0, 2e-7])), attractors(chain, 8)
    known = [one.max_output_force for one in all_of_them]
    for one in found.attractors:
        assert min(abs(one.max_output_force / force - 1.0) for force in known) < 1e-3


def test_what_is_no_plane_is_refused() -> None:
    chain = scene("sec2").evolve(N=2)
    for x, y, words in ((("u3", [0.0]), ("v1", [0.0]), "u1 to u2"), (("w1", [0.0]), ("v1", [0.0]), "Coordinate 'w1'"),
                        (("u1", [0.0]), ("u1", [0.0]), "both u1"), (("u1", []), ("v1", [0.0]), "1 to 250000 starts"),
                        (("u1", [np.nan]), ("v1", [0.0]), "finite")):
        with pytest.raises(BadInput, match=words):
            basins(chain, x, y)
