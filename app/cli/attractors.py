"""`granchain attractors`: the steady states that coexist at one setting, and how many random starts lead to each."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from granchain_core.precompile.pieces import BESIDE_A_BATCH

from .common import chosen_scene, in_background, say, show_json, show_percent
from .compiling import compiling_beside
from .forces import forces_json
from .options import add_json, add_out, add_scene, whole
from .picture import add_option as add_picture
from .picture import check_files, write_files

if TYPE_CHECKING:
    from granchain_core import Attractor, Attractors


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `attractors`."""
    add_scene(parser)
    parser.add_argument("--random-states", type=whole, default=64, metavar="n",
                        help="random starts, 0 to 10,000, in addition to rest and the sweeps up and down")
    parser.add_argument("--seed", type=whole, default=0, metavar="S", help="seed of the random starts")
    add_out(parser)
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Find the steady states of a setting."""
    from granchain_core import attractors
    from granchain_core.attractor_search.attractor import failed_sentence
    from granchain_core.attractor_search.attractors import MOST_STATES
    from granchain_core.inputs.checks import check_range

    chosen = chosen_scene(arguments)
    check_files(arguments)
    check_range("--random-states", arguments.random_states, 0, MOST_STATES)
    check_range("--seed", arguments.seed, 0, 2**63 - 1)
    progress = show_percent if sys.stderr.isatty() else None
    with compiling_beside(chosen, *BESIDE_A_BATCH):
        result = in_background(lambda stop: attractors(chosen, arguments.random_states, arguments.seed, stop, progress),
                               reports=True)
    write_files(arguments, f"Attractors of {chosen.name}", result)
    if arguments.json:
        show_json(_json(result, arguments))
        return
    print("share                  max_output_force_N  stable  starts  motion")
    for attractor in result:
        print(f"{attractor.share_words:>21}  {attractor.max_output_force:18.6g}  {_stability(attractor):>6}  "
              f"{len(attractor.origins):6d}  {attractor.regime.sentence}")
    say(f"{chosen.name}: {len(result)} found from rest, both sweeps and {arguments.random_states} random states.")
    for sentence in failed_sentence(result.failed):
        say(f"{sentence}. The shares count them.")


def _stability(attractor: Attractor) -> str:
    return "–" if attractor.stable is None else "yes" if attractor.stable else "no"


def _interval(attractor: Attractor) -> dict[str, float | None]:
    """Return the 95 % interval of a share; null if no random state was drawn."""
    low, high = attractor.share_interval or (None, None)
    return {"share_low": low, "share_high": high}


def _json(result: Attractors, arguments: argparse.Namespace) -> dict[str, Any]:
    """Return all steady states as one JSON object; shares are null if no random state was drawn."""
    return {"scene": result.scene.name, "knobs": result.scene.knobs, "random_states": arguments.random_states,
            "seed": arguments.seed, "failed": [origin.name for origin in result.failed], "attractors": [{
                "regime": attractor.regime.name, "period": attractor.regime.period, "stable": attractor.stable,
                **forces_json(attractor), "error_estimate": attractor.force_errors.output,
                "error_estimate_elastic": attractor.force_errors.elastic,
                "error_estimate_input": attractor.force_errors.input,
                "share": attractor.share, "share_error": attractor.share_error, **_interval(attractor),
                "starts": [origin.name for origin in attractor.origins]} for attractor in result]}
