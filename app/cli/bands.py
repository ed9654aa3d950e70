"""`granchain bands`: the pass bands of a precompressed chain."""

from __future__ import annotations

import argparse

from .common import chosen_scene, show_json
from .options import add_json, add_scene


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `bands`."""
    add_scene(parser)
    add_json(parser)


def do(arguments: argparse.Namespace) -> None:
    """Print the pass bands of linear waves."""
    from granchain_core import bands

    chosen = chosen_scene(arguments)
    edges = bands(chosen)
    if arguments.json:
        show_json({"bands": edges, "cut_off": edges[-1][1]})
        return
    print(f"{chosen.name}: linear waves in an infinite chain of these beads, precompressed by {chosen.F0:g} N")
    for number, (low, high) in enumerate(edges, start=1):
        print(f"band {number}: {low:.6g} to {high:.6g} Hz")
    print(f"cut-off {edges[-1][1]:.6g} Hz")
