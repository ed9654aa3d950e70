"""Many verdicts as one table, next to the answers of naive RK4 and LSODA for the same scenes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import numpy as np

from .check import SILENT, Verdict

#: A truth known less accurately than this cannot judge an error of 1e-3.
_KNOWN = 1e-4


def known(verdicts: Iterable[Verdict]) -> list[Verdict]:
    """Return the verdicts whose true motion is known well enough to detect an error of 1e-3."""
    return [v for v in verdicts if v.known < _KNOWN]


def silent(verdict: Verdict) -> bool:
    """Return whether the run has an error above 1e-3 that it does not state."""
    return any(name.startswith(("silent", "displacement is not")) for name, _ in verdict.faults)


def silent_other(verdict: Verdict, name: str) -> bool:
    """Return whether another solver returned a result with an error above 1e-3, or NaN."""
    outcome, error = verdict.others[name]
    return outcome == "returned" and not error - 3.0 * verdict.known <= SILENT


def table(verdicts: list[Verdict]) -> str:
    """Return counts by outcome, errors that were not stated, and faults by name, as Markdown."""
    compared = [v for v in verdicts if v.others]
    names = ["naive RK4", "LSODA"]
    outcomes = {n: Counter(v.others[n][0] for v in compared) for n in names}
    rows = [["", "granchain, all", "granchain, the same scenes as", *names],
            ["scenes", str(len(verdicts)), *[str(len(compared))] * 3],
            ["truth known better than 1e-4", str(len(known(verdicts))), *[str(len(known(compared)))] * 3],
            ["of these a silent error above 1e-3", str(sum(map(silent, known(verdicts)))),
             str(sum(map(silent, known(compared)))),
             *[str(sum(silent_other(v, n) for v in known(compared))) for n in names]],
            ["failed or refused, with a message", str(_said(verdicts)), str(_said(compared)),
             *[str(outcomes[n]["failed, and said so"]) for n in names]],
            ["stopped after its time", *[str(sum(v.outcome == "hang" for v in part)) for part in (verdicts, compared)],
             *[str(outcomes[n]["took too long"]) for n in names]]]
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    lines.insert(1, "|" + "---|" * 5)
    sure = [v for v in verdicts if v.judged]
    ratios = np.array([v.error / v.stated for v in sure])
    lines += ["", "| outcome | scenes |", "|---|---|"]
    lines += [f"| {name} | {count} |" for name, count in Counter(v.outcome for v in verdicts).most_common()]
    lines += ["", f"Judged by SciPy in (u, v) too: {sum(v.against_scipy for v in verdicts)}. Truth known better than the error "
              f"stated: {len(sure)}; true over stated error: median {np.median(ratios):.2g}, worst {ratios.max():.3g}."
              if len(sure) else ""]
    lines += ["", "| check that failed | scenes | largest figure |", "|---|---|---|"]
    faults = [fault for v in verdicts for fault in v.faults]
    lines += [f"| {name} | {count} | {max(f for n, f in faults if n == name):.3g} |"
              for name, count in Counter(n for n, _ in faults).most_common()] or ["| nothing | 0 | |"]
    return "\n".join(lines)


def _said(verdicts: list[Verdict]) -> int:
    return sum(v.outcome.startswith(("refused", "failed")) for v in verdicts)


def describe(verdict: Verdict) -> str:
    """Describe a verdict in one line: the draw, its outcome, the checks that failed."""
    faults = ", ".join(f"{name} ({figure:.3g})" for name, figure in verdict.faults) or "all passed"
    return (f"seed {verdict.draw.seed} index {verdict.draw.index}: {verdict.outcome}, {verdict.seconds:.2f} s, true {verdict.error:.2e} "
            f"stated {verdict.stated:.2e} known {verdict.known:.0e}: {faults} {verdict.sentence}\n"
            f"    {verdict.draw.knobs} {verdict.draw.special}")
