"""Mutants of the tension cut: where a contact stops pushing, and what a slack one adds and loses."""

from __future__ import annotations

from . import killers as k
from .mutant import Mutant

_CERTIFIED, _SLACKENING = "kernels/certified.py", "kernels/slackening.py"
_TENSION = "kernels/effects/tension.py"

SLACK = (
    Mutant("cut-kink-not-located", _CERTIFIED, "        if kink < 1.0:", "        if kink < -1.0:",
           "certified steps go across the instant at which a cut contact stops pushing", k.CUT_ENERGY),
    Mutant("slack-of-tsuji", _SLACKENING, "return stiffness * d * root(root(d)) / law.coefficient",
           "return stiffness * d * root(d) / law.coefficient", "the instant at which Tsuji's force ends is another one",
           k.UNLIKE),
    Mutant("slack-of-kuwabara-kono", _SLACKENING, "return stiffness * d / law.coefficient",
           "return stiffness * root(d) / law.coefficient", "the instant at which Kuwabara and Kono's force ends is another one",
           k.UNLIKE),
    Mutant("no-contact-is-slack", _SLACKENING, "slack = d > 0.0 and push(", "slack = d < 0.0 and push(",
           "a step that begins without force ends with a jump at δ = 0", k.CUT_ORDER),
    Mutant("kink-lost-behind-an-event", _SLACKENING, "if x < first and x * h < until * h - _NEAR:", "if x < 0.5 * first:",
           "the later of two kinks in a step is taken for the first", k.CUT_ORDER),
    Mutant("wrong-side-kept", _SLACKENING, "            turned = True", "            turned = False",
           "a contact that rounding put on the wrong side of its kink stays there", k.CUT_SYMMETRY),
    Mutant("one-changes-sides-at-a-time", _SLACKENING, "            turned = True", "            turned = True\n            break",
           "of two mirrored contacts on the wrong side one changes before the other", k.CUT_SYMMETRY),
    Mutant("slack-contact-open-at-once", _TENSION, "if slack or e[c] + damped < 0.0:", "if e[c] + damped < 0.0:",
           "what is added to a slack contact ends with a jump at δ = 0", k.CUT_ORDER),
    Mutant("slack-primitive-ends", _TENSION, "        if tension.slack[c] != 0:\n            keep_primitive(",
           "        if tension.slack[c] > 1:\n            keep_primitive(", "G of a slack contact keeps its kink at δ = 0", k.CUT_ORDER),
    Mutant("slack-overlap-cut", _TENSION, "return overlap(slots.preload, y, c) if tension.slack[c] != 0 else d", "return d",
           "the account of a slack contact takes another G than the motion", k.CUT_ENERGY),
    Mutant("slack-loss-counted-twice", _TENSION, "return 0.0 if tension.slack[c] != 0 else elastic", "return elastic",
           "what a slack contact loses is counted on the way and at the step's end", k.CUT_ENERGY),
    Mutant("slack-loss-forgotten", _TENSION, "lost += elastic_energy(", "lost += 0.0 * elastic_energy(",
           "the elastic energy that a slack contact loses is not in the account", k.CUT_ENERGY),
    Mutant("slack-for-ever", _TENSION, "        if not overlap(slots.preload, y, c) > 0.0:\n            tension.slack[c] = 0",
           "        if not overlap(slots.preload, y, c) > 0.0:\n            tension.slack[c] *= 1",
           "a contact that opened while slack is slack when it closes again", k.CUT_ENERGY),
)
