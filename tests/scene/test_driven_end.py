"""A chain that is driven from its last bead is the reversed chain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from granchain_core import BadInput, Run, run, scene

KNOBS = {"N": 6, "dimer": 0.5, "taper": 0.8, "striker": 2.0, "site": 3, "impurity": 1.7}


def short(chain: str, **knobs: object) -> Run:
    """Return two recorded periods from rest."""
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


def test_equal_beads_move_the_same_driven_from_either_end() -> None:
    assert np.array_equal(short("sec2", N=4, end="last").displacement, short("sec2", N=4).displacement)


@pytest.mark.parametrize("end", ["first", "last"])
def test_start_velocities_count_from_the_driver_and_masses_from_the_first_bead(end: str) -> None:
    chain = replace(scene("impact-train").evolve(N=6, site=2, impurity=0.5, strike=0.02, end=end),
                    start_velocity=((3, -0.01),))
    assert chain.velocities_at_start().tolist() == [0.02, 0.0, -0.01, 0.0, 0.0, 0.0]
    regular = scene("impact").bead(1).mass
    heavy = [6.0, 0.5, 1.0, 1.0, 1.0, 1.0]
    assert chain.masses() / regular == pytest.approx(heavy if end == "first" else heavy[::-1], rel=1e-14)


@pytest.mark.parametrize("thrown", range(1, 7))
def test_a_chain_without_a_drive_moves_the_same_seen_from_either_end(thrown: int) -> None:
    """A wall like a bead makes both ends alike. Seen from the other end, bead i thrown towards the wall is bead N + 1 −
    i thrown towards the driver.
    """
    quiet = scene("impact").evolve(**KNOBS, wall="bead", strike=0.0, f=1e4)
    ours = replace(quiet, start_velocity=((thrown, 0.02),))
    other = replace(quiet.evolve(end="last"), start_velocity=((7 - thrown, -0.02),))
    a, b = (run(one, periods=0, record=2, samples=16, method="dop853") for one in (ours, other))
    scale = np.abs(a.displacement).max()
    assert scale > 1e-7
    np.testing.assert_allclose(b.displacement[:, ::-1], -a.displacement, atol=1e-6 * scale)
    np.testing.assert_allclose(b.force[:, ::-1], a.force, atol=1e-5 * a.force.max())


def test_a_strike_hits_the_bead_beside_the_driver() -> None:
    """That is bead 1 of the results. With `end = "last"` it is the chain's last bead, and equal masses move equally."""
    one, turned = (run(scene("impact").evolve(N=5, end=end, **knobs), periods=0, record=1, samples=32)
                   for end, knobs in (("last", {"striker": 3.0}), ("first", {"site": 5, "impurity": 3.0})))
    assert np.array_equal(one.displacement, turned.displacement)
    assert one.velocity[0].tolist() == [0.01, 0.0, 0.0, 0.0, 0.0]


def test_another_end_is_refused_with_the_nearest() -> None:
    with pytest.raises(BadInput, match="driven end end = 'lats' is not one of first, last; the nearest is 'last'"):
        scene("sec2").evolve(end="lats")
