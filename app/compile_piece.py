"""`python -m app.compile_piece PIECE`: compiles and caches kernels of the scene whose JSON is on standard input."""

import json
import sys

from granchain_core import Scene
from granchain_core.pieces import compile_piece

if __name__ == "__main__":
    compile_piece(Scene.from_json(json.load(sys.stdin)), sys.argv[1])
