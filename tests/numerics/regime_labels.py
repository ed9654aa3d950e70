"""A program that checks the regime labels of frequency sweeps past the special points of section 2's period-1 branch,
in both directions.

    python -m tests.numerics.regime_labels [--places 255.8 832.5] [--width 2] [--step 0.25] [--starts up down rest]

Every point is run again from the state in which the sweep began it, for 5,000 periods with a quarter of the live
method's step, and longer if that does not decide. The motion is periodic with the smallest n for which its strobes
repeat to 1e-9, provided that changes over shorter n are constant. For other motions, the Lyapunov exponent is measured
twice over 2,000 periods: they are chaotic if both values are well above zero, and quasi-periodic if both are near zero.
Motions that this rule cannot decide are not judged.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granchain_core import CurvePoint, Scene, State, iter_curve, scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.scene.state import rest
from granchain_core.steady.lyapunov import growth_along

#: Frequencies [Hz] at which the stability of section 2's period-1 branch changes (`granchain branch sec2`).
PLACES = (146.42, 233.52, 255.80, 511.94, 832.5, 889.0, 1235.6, 1304.9)
#: Periods per run, most periods in total, the refinement of the step, and the relative change that counts as repeated.
PERIODS, PATIENCE, REFINE, REPEATS = 5000, 60_000, 4, 1e-9
#: The longest period considered.
LONGEST = 60
#: An exponent per period below this shows neither chaos nor an approach: on a torus, means over 2,000 periods have
#: smaller errors.
ZERO = 2e-3


@dataclass(frozen=True)
class Judged:
    """A point of a sweep with its label and its true regime; "undecided" if the rule cannot tell."""

    direction: str
    point: CurvePoint
    true: str

    @property
    def called(self) -> str:
        """The regime's label."""
        regime = self.point.regime
        return f"period {regime.period}" if regime.period else regime.name

    @property
    def false(self) -> bool:
        """Whether the label is false: both regimes are decided and differ."""
        return "un" not in (self.called[:2], self.true[:2]) and self.called != self.true

    @property
    def missing(self) -> bool:
        """Whether the label claims no regime."""
        return self.called == "unsettled"


def truth(chosen: Scene, start: State | None) -> str:
    """Return the true regime of the motion from a state at phase 0; None is rest."""
    engine = Engine(chosen, MethodSetting("rk4-split", refine=REFINE), 1)
    engine.start(rest(chosen) if start is None else start)
    for _ in range(PATIENCE // PERIODS):
        strobes, _ = engine.periods(PERIODS, watch=False)
        repeats = [n for n in range(1, LONGEST + 1) if _moved(strobes, n)[1] <= REPEATS]
        if repeats and not any(_changing(strobes, n) for n in range(1, repeats[0])):
            return f"period {repeats[0]}"
        if not _on_its_way(strobes):
            break
    means = [growth_along(engine, 2020)[0][20:].reshape(100, 20).mean(axis=1) for _ in range(2)]
    if all(m.mean() > max(0.01, 4.0 * m.std(ddof=1) / 10.0) for m in means):
        return "chaotic"
    return "quasi-periodic" if all(abs(m.mean()) < ZERO for m in means) and not _on_its_way(strobes) else "undecided"


def _on_its_way(strobes: np.ndarray) -> bool:
    """Return whether changes over some period still shrink or grow."""
    return any(_changing(strobes, n) for n in range(1, LONGEST + 1))


def _moved(strobes: np.ndarray, n: int) -> np.ndarray:
    """Return the largest relative changes over n periods in the last 2,000 periods: in their first half and the second.
    """
    change = np.abs(strobes[n:] - strobes[:-n]) / np.abs(strobes).max(axis=(0, 2))[:, None]
    return np.asarray(change.max(axis=(1, 2))[-2000:].reshape(2, -1).max(axis=1))


def _changing(strobes: np.ndarray, n: int) -> bool:
    """Return whether changes over n periods still shrink or grow; on a slow rotation, those over some n are small."""
    before, now = _moved(strobes, n)
    return not 0.99 * before <= now <= 1.01 * before


def judged(place: float, width: float, step: float, direction: str) -> Iterator[Judged]:
    """Yield the judged points of one sweep."""
    chain = scene("sec2")
    count = round(2.0 * width / step) + 1
    found = list(iter_curve(chain, np.linspace(place - width, place + width, count), direction))
    for before, point in itertools.pairwise([None, *found]):
        assert point is not None
        carried = before is not None and direction != "rest" and not before.failure
        start = before.state if before is not None and carried else None
        yield Judged(direction, point, truth(chain.evolve(f=point.frequency), start))


def main() -> None:
    """Print every false, missing or undecided label, and their numbers."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--places", type=float, nargs="+", default=PLACES)
    parser.add_argument("--width", type=float, default=2.0)
    parser.add_argument("--step", type=float, default=0.25)
    parser.add_argument("--starts", nargs="+", default=["up", "down"], choices=["rest", "up", "down"])
    args = parser.parse_args()
    every: list[Judged] = []
    for place, direction in itertools.product(args.places, args.starts):
        found = list(judged(place, args.width, args.step, direction))
        every += found
        for one in found:
            if one.false or one.missing or one.true == "undecided":
                verdict = "FALSE" if one.false else "open"
                print(f"  {verdict} {direction} {one.point.frequency:.2f} Hz: {one.point.regime.sentence}; is {one.true}",
                      flush=True)
        print(f"{place} Hz {direction}: {len(found)} points, {sum(o.false for o in found)} false, "
              f"{sum(o.missing for o in found)} unsettled, {sum(o.true == 'undecided' for o in found)} not judged", flush=True)
    print(f"{len(every)} points, {sum(o.false for o in every)} false, {sum(o.missing for o in every)} unsettled, "
          f"{sum(o.true == 'undecided' for o in every)} not judged")


if __name__ == "__main__":
    main()
