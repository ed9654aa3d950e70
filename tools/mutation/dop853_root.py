"""Mutants of the equations in a transformed time: dop853-root along a short chain."""

from __future__ import annotations

from . import killers as k
from .mutant import Mutant

_FOLDER = "kernels/dop853_root/"
_CHAIN, _STEP, _CHANGES = _FOLDER + "chain.py", _FOLDER + "step.py", _FOLDER + "changes.py"
_RUN, _FORCES, _INSIDE = _FOLDER + "run.py", _FOLDER + "forces.py", _FOLDER + "inside.py"

DOP853_ROOT = (
    Mutant("dop853-root-foundation-on-neighbour", _CHAIN, "contacts, u, du)",
           "contacts, from_right(u, blank(u)), du)",
           "the foundation pulls each bead by its neighbour's displacement", k.ROOT_FOUNDED),
    Mutant("dop853-root-without-preload", _CHAIN, "row_overlap(values.preload, u, from_right(u, blank(u)))",
           "u - from_right(u, blank(u))", "a pressed chain is a sonic vacuum", k.ROOT_PRESSED),
    Mutant("dop853-root-straight-driver", _CHAIN, "driver_acceleration(driver, at(u, 0))", "driver_acceleration(driver, 0.0)",
           "the driver continues to move as at the last event", k.ROOT),
    Mutant("dop853-root-force-exponent", _CHAIN, "root(pressed), d * r", "root(pressed), d * d",
           "the contact next to its event has the exponent 2", k.ROOT_FORCES),
    Mutant("dop853-root-chosen-undamped", _CHAIN, "du + damping_pull * signed_primitive", "du + 0.0 * damping_pull * signed_primitive",
           "the contact next to its event has no dashpot", k.ROOT_FORCES),
    Mutant("dop853-root-fourth-root", _CHAIN, "return square * q, square, square * square", "return square, square, square * square",
           "dt/dξ is q² if q is a fourth root", k.ROOT_TSUJI),
    Mutant("dop853-root-root-rate", _STEP, "h * transform.active / smooth_power(law)", "h * transform.active",
           "dq/dξ is δ̇ instead of δ̇/p", k.ROOT),
    Mutant("dop853-root-dense-row", _STEP, "2.0 * change - (last + first)", "2.0 * change - (last - first)",
           "dense output with a wrong row", k.ROOT),
    Mutant("dop853-root-opening-unseen", _CHANGES, "crossed = crossed | target if at(step.end.q, 0) < 0.0 else crossed & ~target",
           "crossed = crossed & ~own", "a contact that a step aims at never opens", k.ROOT_FORCES),
    Mutant("dop853-root-touch-unseen", _CHANGES, "turned = turns(bits, rising, risen)",
           "turned = bits & 0", "a touch inside a step is not seen", k.ROOT_TOUCH),
    Mutant("dop853-root-wall-stays-closed", _CHANGES, "all_contacts = (1 << contacts) - 1", "all_contacts = (1 << (contacts - 1)) - 1",
           "the wall's contact neither opens nor closes", k.ROOT),
    Mutant("dop853-root-stays-closed", _RUN, "work.closed[0, contact] = 1.0 - work.closed[0, contact]", "work.closed[0, contact] = 1.0",
           "a contact that has been closed once pulls", k.ROOT),
    Mutant("dop853-root-rounding-is-an-event", _INSIDE, "    if falls:\n", "    if falls and before >= 0.0:\n",
           "the overlap just after an opening, zero except for rounding, is taken for a closing", k.ROOT_ROUNDING),
    Mutant("dop853-root-sample-time", _INSIDE, "work.polynomial[7] = work.start.t[0, 0] - instant",
           "work.polynomial[7] = work.start.t[0, 0] - 0.999 * instant", "samples are read too early", k.ROOT),
    Mutant("dop853-root-force-undamped", _FORCES, "return (at(rates.elastic, 0) + dashpot_force(dissipation, at(rates.overlap, 0), at(rates.rate, 0)),",
           "return (at(rates.elastic, 0),", "the largest input force inside a step omits the dashpot", k.ROOT_FORCES),
    Mutant("dop853-root-end-force-undamped", _FORCES, "force = rates.elastic + dashpot_force(law, rates.overlap, rates.rate)",
           "force = rates.elastic", "the forces at the ends of steps omit the dashpots", k.ROOT_FORCES),
    Mutant("dop853-root-no-jump", _RUN, "record_closing(context.slots.dissipation, at(start.rates.rate, contact)",
           "record_closing(context.slots.dissipation, 0.0 * at(start.rates.rate, contact)", "no force jumps when a contact closes",
           k.ROOT_FORCES),
    Mutant("simd-mark-for-all", "kernels/effects/registry.py", "known = _IN_SIMD_KERNELS[folder] | {type(None)}",
           "known = set().union(*_IN_SIMD_KERNELS.values()) | {type(None)}",
           "an effect that one SIMD kernel supports is silently omitted by the others", k.MARKS),
)
