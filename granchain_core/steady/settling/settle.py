"""`settle` and `settling`: the steady state of a chain, without or with previews of the motion on the way."""

from __future__ import annotations

import time
from collections.abc import Iterator

from ...execution.stop import Stop
from ...inputs.checks import whole_number
from ...results.recorded_motion import MOST_SAMPLES
from ...results.run import start_words
from ...scene import Scene
from ...scene.refusals import require_scene
from ...scene.state import State
from .advance import SettlingRun, run_until_settled
from .outcome import Settled
from .recording import motion_so_far, recorded_orbit
from .undriven import undriven_motion

#: Samples per drive period of the recorded motion.
PICTURE_SAMPLES = 96
#: Time after which a first result is given even though nothing is decided yet [s].
_PREVIEW_AFTER = 0.012


def settling(scene: Scene, start: State | None = None, samples: int = PICTURE_SAMPLES,
             stop: Stop | None = None) -> Iterator[Settled]:
    """Yield successive results of a settling chain: a quick preview first, the refined steady state last.

    Parameters
    ----------
    scene : Scene
        The chain.
    start : State, optional
        Where the motion starts; by default at rest.
    samples : int
        Samples per drive period of each result.
    stop : Stop, optional
        Ends the computation when another thread sets it.

    Yields
    ------
    Settled
        About ten per second; `final` is set on the last.

    Raises
    ------
    BadInput
        `samples` is not a whole number from 1.
    ComputationError
        The motion is no longer finite.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import scene, settling
    >>> [found.final for found in settling(scene("sec2").evolve(N=2, f=2000.0))][-1]
    True
    """
    began, samples = time.perf_counter(), _checked(scene, samples)
    if not scene.is_driven:
        yield undriven_motion(scene, start, samples, began, stop)
        return
    origin = start_words(scene, start)
    motion = SettlingRun(scene, start, stop)
    motion.advance_for(_PREVIEW_AFTER)
    while not motion.decided:
        yield motion_so_far(motion, samples, began, origin, final=False)
        motion.go_on(0.1)
    if motion.regime.name == "periodic":
        yield recorded_orbit(motion, samples, began, origin)
    else:
        yield motion_so_far(motion, samples, began, origin, final=True)


def settle(scene: Scene, start: State | None = None, samples: int = PICTURE_SAMPLES,
           stop: Stop | None = None) -> Settled:
    """Compute the steady state of a chain.

    The chain runs with fixed steps, or with dop853 where tension is cut, until the distance to the orbit is bounded or
    the regime is decided otherwise. A periodic orbit is then computed again with a setting fine enough for the
    requested accuracy (docs/regimes.md).

    Parameters
    ----------
    scene : Scene
        The chain.
    start : State, optional
        Where the motion starts; by default at rest.
    samples : int
        Samples per drive period of the recorded orbit.
    stop : Stop, optional
        Ends the computation when another thread sets it.

    Returns
    -------
    Settled
        One orbit if the motion is periodic, otherwise a few drive periods.

    Raises
    ------
    BadInput
        `samples` is not a whole number from 1.
    ComputationError
        The motion is no longer finite.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import scene, settle
    >>> found = settle(scene("sec2").evolve(N=2, f=2000.0))
    >>> found.regime.name, found.regime.period
    ('periodic', 1)
    >>> f"{found.run.max_output_force_elastic:.3f} N"
    '2.260 N'
    """
    began, samples = time.perf_counter(), _checked(scene, samples)
    if not scene.is_driven:
        return undriven_motion(scene, start, samples, began, stop)
    motion = run_until_settled(scene, start, stop)
    origin = start_words(scene, start)
    if motion.regime.name == "periodic":
        return recorded_orbit(motion, samples, began, origin)
    return motion_so_far(motion, samples, began, origin, final=True)


def _checked(scene: Scene, samples: int) -> int:
    """The number of samples as an int. Raises `BadInput` if it is out of range, or if `scene` is not a scene."""
    require_scene(scene)
    return whole_number("samples =", samples, 1, MOST_SAMPLES)
