"""The equations of motion in w-variables, assembled from the effects present: the reference form.

chain_in_vector.py, rk4/long_chain.py, dop853_root/chain.py and batch/step.py repeat them in vectors, naive.py writes
them in (u, v), and flow/tangent.py and flow/velocity_tangent.py linearise them. tests/kernels/equations/test_motion.py
compares this file with the paper's equations; tests/kernels, tests/numerics/test_methods_agree.py and
tests/orbits/test_tangents.py compare the others with it.

    w_i = v_i − (G_{i-1} − G_i)/m_i          the dashpot is an exact derivative (docs/method.md)
    u̇_i = w_i + (G_{i-1} − G_i)/m_i
    m_i ẇ_i = F^el_{i-1} − F^el_i + P_i       continuous: no Heaviside function, no velocity differences;
                                              P_i, such as −k u_i, from body_forces.py

One flat array y holds u_0..u_{N+1}, then w_0..w_{N+1}, then (with an energy account) work and loss; driver and wall are
the ends of both rows, so that every loop runs over all contacts without special cases.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compiling.jit import brief_kernel, inline_llvm, internal
from ..effects.batch_values import batch_values
from ..effects.contact import closed_overlap, elastic_energy, elastic_force
from ..effects.dissipation import dashpot_force, v_from_w, w_from_v, write_primitive
from ..effects.driver import driver_displacement, driver_velocity
from ..effects.energy_account import account_rates
from ..effects.given_force import put_given_force, put_given_primitive
from ..effects.preload import overlap
from ..effects.registry import check_effects
from ..effects.tension import cut_tension, unless_force_free, write_force_free_primitive
from ..simd.functions import positive_part
from .body_forces import account_for_bodies, force_on_bead, stored_on_bead


class Slots(NamedTuple):
    """One slot per effect, None if it is absent; the types of the slots alone determine the compiled code."""

    chain: Any
    dissipation: Any = None
    tension: Any = None
    foundation: Any = None
    preload: Any = None
    driver: Any = None
    account: Any = None


@inline_llvm
def batch_slots(slots):
    """Return the slots of a batch with their numbers as vectors over all members."""
    return Slots(
        slots.chain,
        batch_values(slots.dissipation),
        slots.tension,
        batch_values(slots.foundation),
        batch_values(slots.preload),
        slots.driver,
        slots.account,
    )


class Forces(NamedTuple):
    """Workspace of one evaluation: elastic forces e (N+1,) and primitives G (N+1,), None without dissipation.

    `frozen` is None, or specifies the contacts that stay open whatever their overlap.
    """

    e: np.ndarray
    G: Any
    frozen: Any = None


class Trajectory(NamedTuple):
    """The input of an integration: the chain's slots, the drive, state y (M,) and the method's workspace.

    `drive` is a `DriveCycle` for steps of any size (error_control/step.py), or a `DriveTable` for equal steps
    (rk4/step.py). M is 2(N + 2), plus two with an energy account.
    """

    slots: Slots
    drive: Any
    y: np.ndarray
    workspace: Any


# Every effect has a term that the equations call, so the imports above have loaded all modules of effects.
check_effects("granchain_core.kernels.effects")


@internal
def motion(slots, u0, v0, y, dy, forces):
    """Compute dy/dτ at state y with the driver at (u0, v0); leave the contact forces in `forces`."""
    inverse_mass, stiffness = slots.chain.inverse_mass, slots.chain.stiffness
    e, G = forces.e, forces.G
    bodies = inverse_mass.size
    y[0] = u0
    dy[0] = v0
    for c in range(bodies - 1):
        d = closed_overlap(forces.frozen, c, overlap(slots.preload, y, c))
        e[c] = elastic_force(stiffness[c], d)
        write_primitive(slots.dissipation, G, c, d)
    write_force_free_primitive(slots.tension, slots, y, G)
    put_given_primitive(slots.driver, slots, y, G)
    for i in range(1, bodies - 1):
        dy[i] = v_from_w(slots.dissipation, inverse_mass, y[bodies + i], G, i)
    cut_tension(slots.tension, slots, y, dy, e)
    put_given_force(slots.driver, dy, e)
    for i in range(1, bodies - 1):
        dy[bodies + i] = inverse_mass[i] * force_on_bead(slots, i, e[i - 1] - e[i], y[i], dy[i])
    account_rates(slots.account, slots, y, dy, e)
    account_for_bodies(slots.account, slots, y, dy)


@internal
def contact_force(slots, y, dy, e, c):
    """Total force of contact c from the last evaluation of `motion`, positive in compression."""
    damped = dashpot_force(slots.dissipation, overlap(slots.preload, y, c), dy[c] - dy[c + 1])
    return unless_force_free(slots.tension, c, e[c] + damped)


@internal
def copy(source, target):
    """Copy an array. A slice assignment takes seconds longer to compile, because Numba adds checks of the shapes."""
    for i in range(source.size):
        target[i] = source[i]


@internal
def write_w(slots, y, dy, forces):
    """Write w of state y from the velocities in dy."""
    bodies = slots.chain.inverse_mass.size
    for c in range(bodies - 1):
        write_primitive(slots.dissipation, forces.G, c, positive_part(overlap(slots.preload, y, c)))
    put_given_primitive(slots.driver, slots, y, forces.G)
    for i in range(1, bodies - 1):
        y[bodies + i] = w_from_v(slots.dissipation, slots.chain.inverse_mass, dy[i], forces.G, i)


@brief_kernel
def evaluate_at_phase(slots, theta, y, dy, forces, from_velocity):
    """Evaluate the equations at drive phase θ: the driver's displacement in y, the slope in dy, the forces.

    With `from_velocity` the second row of y contains v on entry and w on return.
    """
    bodies = slots.chain.inverse_mass.size
    u0 = driver_displacement(slots.driver, theta)
    y[0] = u0
    if from_velocity:
        for i in range(1, bodies - 1):
            dy[i] = y[bodies + i]
        write_w(slots, y, dy, forces)
    motion(slots, u0, driver_velocity(slots.driver, theta), y, dy, forces)


@internal
def stored_energy(slots, y, dy):
    """Sum of kinetic energy, contact energy and energy stored in forces from outside; velocities are read from dy."""
    inverse_mass = slots.chain.inverse_mass
    bodies = inverse_mass.size
    energy = 0.0
    for c in range(bodies - 1):
        energy += elastic_energy(slots.chain.stiffness[c], positive_part(overlap(slots.preload, y, c)))
    for i in range(1, bodies - 1):
        energy += 0.5 * dy[i] * dy[i] / inverse_mass[i] + stored_on_bead(slots, i, y[i])
    return energy
