"""`granchain warm`: compile kernels ahead of time."""

from __future__ import annotations

import argparse

from .common import say


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `warm`."""
    parser.add_argument("scene", nargs="*", help="scenes whose kernels to compile; by default the paper's scenes")
    parser.add_argument("--list", action="store_true", help="list what is compiled on this machine, without compiling")


def do(arguments: argparse.Namespace) -> None:
    """Compile the kernels of the paper's scenes, or of those named, ahead of time; or list what is compiled."""
    from granchain_core.precompile.warm import USUAL, compiled_lines, warm_scenes

    if arguments.list:
        for line in compiled_lines(arguments.scene or USUAL):
            print(line)
        return
    for done in warm_scenes(arguments.scene or USUAL):
        say("compiled", done)
