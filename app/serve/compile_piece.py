"""`python -m app.serve.compile_piece PIECE`: compile and cache kernels of the scene on standard input (JSON)."""

import json
import sys

from granchain_core import Scene
from granchain_core.pieces import compile_piece

if __name__ == "__main__":
    compile_piece(Scene.from_json(json.load(sys.stdin)), sys.argv[1])
