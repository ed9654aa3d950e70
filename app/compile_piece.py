"""`python -m app.compile_piece PIECE`: compiles and caches kernels of the scene whose JSON is on standard input."""

import json
import sys

from granchain_core import Scene
from granchain_core.warm import warm

if __name__ == "__main__":
    warm(Scene.from_json(json.load(sys.stdin)), (sys.argv[1],))
