"""`granchain cite`: what to cite for the effects of a scene."""

from __future__ import annotations

import argparse

from .common import chosen_scene, show_json
from .options import add_json, add_scene


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `cite`."""
    add_scene(parser)
    add_json(parser)


def do(arguments: argparse.Namespace) -> None:
    """Print the citations."""
    from granchain_core.scene.cite import citations

    references = citations(chosen_scene(arguments))
    if arguments.json:
        show_json({"citations": [{"for": what, "text": text} for what, text in references]})
        return
    for what, text in references:
        print(f"{what}: {text}")
