"""A chain that is driven from its last bead is the chain turned round."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import BadInput, Run, run, scene

KNOBS = {"N": 6, "dimer": 0.5, "taper": 0.8, "striker": 2.0, "site": 3, "impurity": 1.7}


def short(chain: str, **knobs: object) -> Run:
    """Two recorded periods from rest."""
    return run(scene(chain).evolve(**knobs), periods=0, record=2, samples=16)


def test_beads_and_contacts_come_in_the_other_order() -> None:
    first, last = (scene("sec2").evolve(**KNOBS, wall="bead", end=end) for end in ("first", "last"))
    assert len(set(first.beads)) == 6
    assert last.beads == first.beads[::-1]
    assert last.contact_stiffness() == pytest.approx(first.contact_stiffness()[::-1], rel=1e-14)


def test_the_diode_turned_round_is_its_reverse() -> None:
    ours, reverse = short("diode", end="last"), short("diode-reverse")
    assert np.array_equal(ours.displacement, reverse.displacement) and np.array_equal(ours.force, reverse.force)
    assert not np.array_equal(ours.force, short("diode").force)


def test_equal_beads_do_not_know_their_end() -> None:
    assert np.array_equal(short("sec2", N=4, end="last").displacement, short("sec2", N=4).displacement)


def test_another_end_is_refused_with_the_nearest() -> None:
    with pytest.raises(BadInput, match="driven end end = 'lats' is not one of first, last; the nearest is 'last'"):
        scene("sec2").evolve(end="lats")
