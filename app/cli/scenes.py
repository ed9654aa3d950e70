"""`granchain scenes`: every scene and what to look at in it."""

from __future__ import annotations

import argparse

from granchain_core import scene, scene_names

from .common import show_json
from .options import add_json


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `scenes`."""
    add_json(parser)


def do(arguments: argparse.Namespace) -> None:
    """List the scenes."""
    scenes = [scene(name) for name in scene_names()]
    if arguments.json:
        show_json({"scenes": [{"name": s.name, "title": s.title, "look_at": s.look_at, "paper": s.paper,
                               "knobs": s.knobs, "effects": s.effects} for s in scenes]})
        return
    for row in scenes:
        print(f"{row.name:10}  {row.title}\n{'':10}  {row.look_at}")
