"""`run_many`: many scenes on all cores, with one result for each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from ..errors import BadInput, Cancelled, ComputationError, OverBudget
from ..execution.stop import Stop
from ..inputs.checks import series_in
from ..results.regime import Regime
from ..results.regime_columns import regime_columns
from ..results.run import Run
from ..scene import Scene
from ..scene.quantities import QUANTITIES
from ..scene.refusals import require_scene
from ..scheduler import results
from ..steady.batch.threads import on_all_cores
from ..steady.settling.outcome import Settled
from ..tables import MAXIMA, Column, Labelled, Table, axis, error_columns, force_columns
from ..tables.provenance import Attribute, made
from .to_accuracy import run

#: Maximum number of scenes in one batch.
MOST_SCENES = 100_000


Outcome = tuple[Any, str]
"""A result and "", or None and the reason of the failure."""


class Runs(list[Any], Labelled):
    """The results of many scenes, in the order of the scenes; None where the computation failed.

    Attributes
    ----------
    scenes : list of Scene
        The chains.
    failures : list of str
        For each scene, a sentence if its computation failed, otherwise "".

    Examples
    --------
    >>> from granchain_core import run_many, scene
    >>> found = run_many([scene("sec2").evolve(N=2, f=f) for f in (1900.0, 2000.0)], periods=40, record=1)
    >>> len(found), found.failures
    (2, ['', ''])
    """

    scenes: list[Scene]
    failures: list[str]

    def __init__(self, scenes: Sequence[Scene], results: Iterable[Any], failures: Sequence[str]) -> None:
        super().__init__(results)
        self.scenes, self.failures = list(scenes), list(failures)

    def tables(self) -> tuple[Table, ...]:
        """One table, `runs`: each scene's knobs and failure; for motions, regime and largest forces with errors too."""
        along = ("run",)
        columns = {"scene": _words([scene.name for scene in self.scenes], "name of the scene"),
                   "scene_digest": _words([scene.digest for scene in self.scenes], "hash of everything in the scene")}
        for name, quantity in QUANTITIES.items():
            values = [getattr(scene, name) for scene in self.scenes]
            if any(isinstance(value, str) for value in values):
                columns[name] = _words([str(value) for value in values], quantity.label)
            else:
                columns[name] = Column(np.array(values), along, quantity.unit, quantity.label)
        return (Table("runs", axis("run", np.arange(len(self.scenes)), "1", "number of the scene"), {
            **columns, **self._of_motions(),
            "failure": _words(self.failures, "why there is no result; empty where there is one")}),)

    def _of_motions(self) -> dict[str, Column]:
        """Forces, errors and regimes, if all results are motions."""
        along, runs = ("run",), [motion.run if isinstance(motion, Settled) else motion for motion in self]
        if not all(motion is None or isinstance(motion, Run) for motion in runs):
            return {}
        regimes = [Regime.unsettled(0) if motion is None else motion.regime for motion in self]
        forces = np.array([[np.nan] * 3 if motion is None else [getattr(motion, name) for name in MAXIMA]
                           for motion in runs])
        errors = np.array([[np.nan] * 3 if motion is None else motion.force_errors.row for motion in runs])
        return {**force_columns(forces.reshape(-1, 3), along, "over the recorded time"),
                **error_columns(errors.reshape(-1, 3), along), **regime_columns(regimes, "run")}

    def attributes(self) -> dict[str, Attribute]:
        """Versions, machine and time; each result has its own attributes."""
        return made()

    def heading(self) -> str:
        """Number and names of the scenes."""
        return f"{len(self)} runs of {', '.join(sorted({scene.name for scene in self.scenes}))}"

    def summary(self) -> list[str]:
        """Number of results by regime, and the failures."""
        kinds: dict[str, int] = {}
        for result in self:
            regime = getattr(result, "regime", None)
            name = ("failed" if result is None else "done" if regime is None else
                    f"period {regime.period}" if regime.period else regime.name)
            kinds[name] = kinds.get(name, 0) + 1
        return [", ".join(f"{count} {name}" for name, count in sorted(kinds.items())),
                *sorted({failure for failure in self.failures if failure})]

    def __repr__(self) -> str:
        return "\n  ".join([self.heading(), *self.summary()])


def _words(values: list[str], meaning: str) -> Column:
    return Column(np.array(values, dtype=object), ("run",), "", meaning)


def run_many(scenes: Iterable[Scene], work: Callable[..., Any] = run,
             progress: Callable[[float], None] | None = None, stop: Stop | None = None, workers: int | None = None,
             scheduler: Any = None, **options: Any) -> Runs:
    """Run many scenes, on all cores or by the workers of a Dask scheduler.

    Parameters
    ----------
    scenes : iterable of Scene
        The chains, at most 100,000.
    work : callable
        `run`, `settle` for steady states, or another function of a scene, for example `orbit`, from whose results
        branches can start.
    progress : callable, optional
        Called with the completed fraction, 0 to 1, after each scene.
    stop : Stop, optional
        Ends the computation when another thread sets it.
    workers : int, optional
        Number of threads; by default one per core.
    scheduler : distributed.Client, optional
        Its workers compute the scenes, each one scene at a time.
    **options
        Arguments of `work` for every scene: `periods`, `record`, `samples`, `method`, …

    Returns
    -------
    Runs
        A list of results in the order of the scenes. If a scene fails or would exceed its budget, its result is None
        and `failures` says why; the others continue.

    Raises
    ------
    BadInput
        No scene, too many scenes, or an invalid option.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import run_many, scene, settle
    >>> chains = [scene("sec2").evolve(N=2, f=2000.0, D=D) for D in (80.0, 100.0, 120.0)]
    >>> found = run_many(chains, settle)
    >>> [one.regime.period for one in found]
    [1, 1, 1]
    """
    chains = _checked(scenes)
    stop = Stop() if stop is None else stop
    listed: list[Any] = [None] * len(chains)
    failures, done = [""] * len(chains), 0
    outcomes = _on_this_machine(chains, work, options, stop, workers) if scheduler is None else \
        results(scheduler, attempted, [(work, chain, options) for chain in chains], stop)
    for number, (result, failure) in outcomes:
        listed[number], failures[number], done = result, failure, done + 1
        if progress is not None:
            progress(done / len(chains))
    if done < len(chains):
        raise Cancelled
    return Runs(chains, listed, failures)


def _checked(scenes: Iterable[Scene]) -> list[Scene]:
    """Return the scenes of a batch as a list. Raises `BadInput` if one is not a scene, or if they are too many."""
    if isinstance(scenes, Scene):
        raise BadInput("A batch is a list of scenes, not one scene; [scene] is a list of one.")
    chains = series_in("The scenes of a batch", scenes)
    for chain in chains:
        require_scene(chain)
    if not 1 <= len(chains) <= MOST_SCENES:
        raise BadInput(f"A batch has 1 to {MOST_SCENES} scenes, not {len(chains)}.")
    return chains


def _on_this_machine(chains: list[Scene], work: Callable[..., Any], options: dict[str, Any], stop: Stop,
                     workers: int | None) -> Iterable[tuple[int, Outcome]]:
    """The outcomes of all chains, each with its chain's number, as the cores finish them."""
    ended = Stop()

    def some(shared: Iterator[tuple[int, Scene]]) -> Iterator[tuple[int, Outcome]]:
        for number, chain in shared:
            yield number, attempted(work, chain, {**options, "stop": ended})

    return on_all_cores(some, enumerate(chains), ended, stop, workers)


def attempted(work: Callable[..., Any], chain: Scene, options: dict[str, Any]) -> Outcome:
    """Return the result of `work` for a chain, or None and the sentence with which the computation failed."""
    try:
        return work(chain, **options), ""
    except (ComputationError, OverBudget) as problem:
        return None, str(problem)
