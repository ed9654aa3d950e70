"""Mutants of the tension cut: where a contact stops pushing, and what a force-free contact adds and dissipates."""

from __future__ import annotations

from . import killers as k
from .mutant import Mutant

_LOCATED, _KINKS = "kernels/error_control/located_step.py", "kernels/error_control/force_kinks.py"
_CONTROLLED_RUN = "kernels/error_control/run.py"
_TENSION = "kernels/effects/tension.py"

FORCE_FREE = (
    Mutant("cut-kink-not-located", _LOCATED, "        if outcome == KINK:", "        if outcome == KINK + 9:",
           "steps with error control cross the instant at which a cut contact stops pushing", k.CUT_ENERGY),
    Mutant("force-free-of-tsuji", _KINKS, "stiffness * d * (r / power(law, d, r))", "stiffness * d * r",
           "the instant at which Tsuji's force ends is wrong",
           k.UNEQUAL),
    Mutant("force-free-of-kuwabara-kono", _KINKS, "stiffness * d * (r / power(law, d, r))", "stiffness * r * (r / power(law, d, r))",
           "the instant at which Kuwabara and Kono's force ends is wrong",
           k.UNEQUAL),
    Mutant("no-contact-is-force-free", _KINKS, "if d > 0.0 and scaled_force(", "if d < 0.0 and scaled_force(",
           "a step that begins without force ends with a jump at δ = 0", k.FORCE_FREE_ENERGY),
    Mutant("later-kink-first", _KINKS, "if x < first and x * step.h < until * step.h - _LEAST_DISTANCE:", "if x < 0.5 * first:",
           "the later of two kinks in a step is taken for the first", k.FORCE_FREE_ENERGY),
    Mutant("wrong-side-kept", _KINKS, "            turned = True", "            turned = False",
           "a contact that rounding put on the wrong side of its kink stays there", k.FORCE_FREE),
    Mutant("sign-of-rounding-believed", _KINKS, "        elif not skip_wrong_side:", "        elif not skip_wrong_side and free == (f0 < 0.0):",
           "a force that is rounding decides whether a contact is on the wrong side", k.FORCE_FREE),
    Mutant("one-changes-sides-at-a-time", _KINKS, "            turned = True", "            turned = True\n            break",
           "of two mirrored contacts on the wrong side one changes before the other", k.CUT_SYMMETRY),
    Mutant("w-stays-force-free", _KINKS, "        write_w(slots, y, dy, workspace.forces)", "        pass",
           "w keeps the straight G where the law's own is needed", k.FORCE_FREE),
    Mutant("account-stays-force-free", _KINKS, "add_to_account(slots.account, y, energy_in - own_energy_in, lost - own_lost)", "pass",
           "the account keeps the straight G where the law's own is needed", k.FORCE_FREE_ENERGY),
    Mutant("force-free-slope-stays", _CONTROLLED_RUN, "if changed or end == period:", "if end == period:",
           "the next step starts with the slope of the straight G", k.FORCE_FREE),
    Mutant("force-free-offset", _TENSION, "- tension.slope[c] * d\n", "+ tension.slope[c] * d\n",
           "the straight G does not begin where the law's is", k.FORCE_FREE),
    Mutant("force-free-contact-pushes-nothing-away", _TENSION, "            e[c] = -tension.slope[c] * rate", "            e[c] = 0.0",
           "a force-free contact's damping acts", k.FORCE_FREE),
    Mutant("force-free-primitive-ends", _TENSION, "        if tension.force_free[c] != 0:\n            put_primitive(",
           "        if tension.force_free[c] > 1:\n            put_primitive(", "G of a force-free contact is the law's in the motion only",
           k.FORCE_FREE),
    Mutant("force-free-account-of-the-law", _TENSION, "        return tension.offset[c] + tension.slope[c] * overlap(slots.preload, y, c)\n",
           "        return primitive(slots.dissipation, d)\n", "a force-free contact keeps the law's G, and its force uses the straight one", k.FORCE_FREE),
    Mutant("force-free-force-told", _TENSION, "return 0.0 if tension.force_free[c] != 0 else force", "return force",
           "a force-free contact reports the difference of two dampings", k.FORCE_FREE_ENERGY),
    Mutant("force-free-loss-forgotten", _TENSION, "lost += elastic_energy(", "lost += 0.0 * elastic_energy(",
           "the elastic energy that a force-free contact loses is not in the account", k.CUT_ENERGY),
)
