"""Basins in a plane: a long run from each start ends on the attractor that its cell names."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import BadInput, State, attractors, basins, scene
from granchain_core.execution.stop import Stop
from granchain_core.steady.settling.single_chain import settle_to_forces

#: A motion of period 4 and a quasi-periodic one, both with many starts in the plane of docs/analysis.md.
SHARED = scene("sec2").evolve(f=1641.0, A0=0.53e-6)
#: Allowed relative difference of the largest forces of one motion if no error is stated: those of the quasi-periodic
#: one, over 100 periods, differ by 0.2 %. The forces of the two motions differ by a factor of four.
_FORCE_DIFFERENCE = 0.01


def test_each_start_ends_where_its_cell_says() -> None:
    u, v = np.array([-1e-6, 0.0, 1e-6]), np.array([-0.01, 0.0, 0.01])
    found = basins(SHARED, ("u1", u), ("v11", v))
    assert found.number.shape == (3, 3) and found.shares.sum() == pytest.approx(1.0)
    assert [(one.regime.name, one.regime.period) for one in found.attractors] == [("periodic", 4), ("quasi-periodic", None)]
    # the file has the share of the plane that leads to each attractor, without an error, since no state is random
    table = found.to_xarray("attractors")
    assert set(table["share_of"].values) == {"starts of the plane"}
    assert table["share"].values.tolist() == found.shares.tolist() and np.isnan(table["share_error"]).all()
    cells = [(0, 0), (0, 1), (1, 1), (1, 2)]
    assert {int(found.number[cell]) for cell in cells} == {0, 1}
    for row, column in cells:
        state = np.zeros((2, 11))
        state[0, 0], state[1, 10] = u[column], v[row]
        alone = settle_to_forces(SHARED, State(*state), Stop())
        named = found.attractors[found.number[row, column]]
        assert (alone.regime.name, alone.regime.period) == (named.regime.name, named.regime.period)
        errors = (named.error_estimate, alone.output_force_error)
        difference = _FORCE_DIFFERENCE if None in errors else sum(errors)
        assert difference <= _FORCE_DIFFERENCE
        assert alone.maxima[1] == pytest.approx(named.max_output_force, rel=difference)


def test_the_attractors_are_those_of_random_starts() -> None:
    found = basins(SHARED, ("u1", [-1e-6, 1e-6]), ("v11", [-0.01, 0.01])).attractors
    known = {one.regime.name: one.max_output_force for one in attractors(SHARED, 8)}
    assert len(found) == len(known) == 2
    for one in found:
        assert one.max_output_force == pytest.approx(known[one.regime.name], rel=_FORCE_DIFFERENCE)


def test_invalid_planes_are_refused() -> None:
    chain = scene("sec2").evolve(N=2)
    for x, y, words in ((("u3", [0.0]), ("v1", [0.0]), "u1 to u2"), (("w1", [0.0]), ("v1", [0.0]), "Coordinate 'w1'"),
                        (("u1", [0.0]), ("u1", [0.0]), "both u1"), (("u1", []), ("v1", [0.0]), "1 to 250000 starts"),
                        (("u1", [np.nan]), ("v1", [0.0]), "finite")):
        with pytest.raises(BadInput, match=words):
            basins(chain, x, y)
