"""`python -m app.compile_piece PIECE`: compiles and caches kernels of the scene whose JSON is on standard input."""

import json
import sys

from app.compiling import load
from granchain_core import Scene

if __name__ == "__main__":
    load(Scene.from_json(json.load(sys.stdin)), sys.argv[1])
