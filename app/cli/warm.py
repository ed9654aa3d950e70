"""`granchain warm`: compile kernels ahead of time."""

from __future__ import annotations

import argparse

from .common import say


def add_options(parser: argparse.ArgumentParser) -> None:
    """Nothing: the command takes no options."""


def do(arguments: argparse.Namespace) -> None:
    """Compile the kernels of all presets, ahead of time."""
    from granchain_core.warm import warm_presets

    for done in warm_presets():
        say("compiled", done)
