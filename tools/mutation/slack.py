"""Mutants of the tension cut: where a contact stops pushing, and what a slack one adds and loses."""

from __future__ import annotations

from . import killers as k
from .mutant import Mutant

_CERTIFIED, _SLACKENING = "kernels/dop853/run.py", "kernels/dop853/force_kinks.py"
_TENSION = "kernels/effects/tension.py"

SLACK = (
    Mutant("cut-kink-not-located", _CERTIFIED, "        if kink < 1.0:", "        if kink < -1.0:",
           "certified steps go across the instant at which a cut contact stops pushing", k.CUT_ENERGY),
    Mutant("slack-of-tsuji", _SLACKENING, "stiffness * d * (r / power(law, d, r))", "stiffness * d * r",
           "the instant at which Tsuji's force ends is another one",
           k.UNLIKE),
    Mutant("slack-of-kuwabara-kono", _SLACKENING, "stiffness * d * (r / power(law, d, r))", "stiffness * r * (r / power(law, d, r))",
           "the instant at which Kuwabara and Kono's force ends is another one",
           k.UNLIKE),
    Mutant("no-contact-is-slack", _SLACKENING, "if d > 0.0 and scaled_force(", "if d < 0.0 and push(",
           "a step that begins without force ends with a jump at δ = 0", k.CUT_ORDER),
    Mutant("later-kink-first", _SLACKENING, "if x < first and x * step.h < until * step.h - _NEAR:", "if x < 0.5 * first:",
           "the later of two kinks in a step is taken for the first", k.CUT_ORDER),
    Mutant("wrong-side-kept", _SLACKENING, "            turned = True", "            turned = False",
           "a contact that rounding put on the wrong side of its kink stays there", k.SLACK),
    Mutant("sign-of-rounding-believed", _SLACKENING, "        elif not again:", "        elif not again and slack == (f0 < 0.0):",
           "a force that is rounding decides whether a contact is on the wrong side", k.SLACK),
    Mutant("one-changes-sides-at-a-time", _SLACKENING, "            turned = True", "            turned = True\n            break",
           "of two mirrored contacts on the wrong side one changes before the other", k.CUT_SYMMETRY),
    Mutant("w-stays-slack", _SLACKENING, "        write_w(slots, y, dy, work.forces)", "        pass",
           "w keeps the straight G where the law's own is meant", k.SLACK),
    Mutant("account-stays-slack", _SLACKENING, "add_to_account(slots.balance, y, work_done - own_work, lost - own_lost)", "pass",
           "the account keeps the straight G where the law's own is meant", k.CUT_LAWS),
    Mutant("slack-slope-stays", _CERTIFIED, "if changed or end == period:", "if end == period:",
           "the slope with the straight G begins the next step", k.SLACK),
    Mutant("slack-offset", _TENSION, "- tension.slope[c] * d\n", "+ tension.slope[c] * d\n",
           "the straight G does not begin where the law's is", k.SLACK),
    Mutant("slack-contact-pushes-nothing-away", _TENSION, "            e[c] = -tension.slope[c] * rate", "            e[c] = 0.0",
           "a slack contact's damping acts", k.SLACK),
    Mutant("slack-primitive-ends", _TENSION, "        if tension.slack[c] != 0:\n            put_primitive(",
           "        if tension.slack[c] > 1:\n            put_primitive(", "G of a slack contact is the law's in the motion alone",
           k.SLACK),
    Mutant("slack-account-of-the-law", _TENSION, "        return tension.offset[c] + tension.slope[c] * overlap(slots.preload, y, c)\n",
           "        return primitive(slots.dissipation, d)\n", "a slack contact keeps the law's G, and its force takes the straight one", k.CUT_LAWS),
    Mutant("slack-force-told", _TENSION, "return 0.0 if tension.slack[c] != 0 else force", "return force",
           "a slack contact reports the difference of two dampings", k.CUT_LAWS),
    Mutant("slack-loss-forgotten", _TENSION, "lost += elastic_energy(", "lost += 0.0 * elastic_energy(",
           "the elastic energy that a slack contact loses is not in the account", k.CUT_ENERGY),
)
