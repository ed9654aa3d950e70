"""A process that compiles for the server and ends when the server ends.

Its arguments are PARENT PIECE; it reads the scene as JSON from standard input.
"""

from __future__ import annotations

import json
import sys

from granchain_core.execution.child_processes import end_with_parent


def main(parent: str, piece: str) -> None:
    """Start watching the parent before the imports, which take seconds, and then compile."""
    end_with_parent(int(parent))
    from granchain_core import Scene
    from granchain_core.precompile.warm import compile_piece

    compile_piece(Scene.from_json(json.load(sys.stdin)), piece)


if __name__ == "__main__":
    main(*sys.argv[1:])
