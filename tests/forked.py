"""Run Python commands in separate processes that start with the large libraries already imported.

Importing Numba takes a third of a second and Panel a second, and the tests that follow a page of docs or examine a
kernel cache start about a hundred processes. Here a server process, which has imported no module of granchain, imports
the libraries once, and each command runs in a fork of it. Tests about the start of a process or about its signals start
processes in the usual way.
"""

from __future__ import annotations

import atexit
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from subprocess import CompletedProcess
from typing import IO

#: The server reads one command per line, and answers with the command's exit status and output. In a child process, the
#: `for` loop ends and the command runs.
_SERVER = """
import gc, importlib, json, os, runpy, sys, types
from concurrent.futures import ThreadPoolExecutor
for name in sys.argv[1:]:
    importlib.import_module(name)
gc.collect()
gc.freeze()
def read(place):
    with os.fdopen(place, encoding="utf-8") as stream:
        return stream.read()
answers, base, asked = os.fdopen(os.dup(1), "w"), sys.path[1:], None
for line in sys.stdin:
    pipes = [os.pipe() for _ in range(2)]
    child = os.fork()
    if not child:
        asked = json.loads(line)
        break
    for _, end in pipes:
        os.close(end)
    with ThreadPoolExecutor() as pool:
        printed = list(pool.map(read, [begin for begin, _ in pipes]))
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    print(json.dumps([status, *printed]), file=answers, flush=True)
if asked is None:
    os._exit(0)
os.environ.clear()
os.environ.update(asked["environment"])
os.umask(asked["umask"])
os.chdir(asked["folder"])
for number, place in enumerate((os.open(os.devnull, os.O_RDONLY), pipes[0][1], pipes[1][1])):
    os.dup2(place, number)
    os.close(place)
for begin, _ in pipes:
    os.close(begin)
answers.close()
sys.stdin = open(0, closefd=False)
if "numba" in sys.modules:
    sys.modules["numba"].core.config.reload_config()
option, what, *words = asked["arguments"]
given = [path for path in os.environ.get("PYTHONPATH", "").split(os.pathsep) if path]
sys.path[:] = ["" if option == "-c" else os.getcwd(), *given, *base]
importlib.invalidate_caches()
if option == "-m":
    sys.argv[:] = ["-m", *words]
    runpy.run_module(what, run_name="__main__", alter_sys=True)
else:
    sys.argv[:] = ["-c", *words]
    sys.modules["__main__"] = main = types.ModuleType("__main__")
    exec(compile(what, "<string>", "exec"), vars(main))
"""


@cache
def _server(libraries: tuple[str, ...]) -> subprocess.Popen[str]:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    server = subprocess.Popen([sys.executable, "-c", _SERVER, *libraries], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              env=environment, cwd=tempfile.gettempdir(), text=True)
    atexit.register(_end, server)
    return server


def _end(server: subprocess.Popen[str]) -> None:
    for stream in (server.stdin, server.stdout):
        _opened(stream).close()
    server.wait(60)


def _opened(stream: IO[str] | None) -> IO[str]:
    assert stream is not None
    return stream


def python(*arguments: str, folder: Path, environment: Mapping[str, str],
           libraries: tuple[str, ...] = ("numba",)) -> CompletedProcess[str]:
    """Run `python ARGUMENTS` in a folder; the first argument is `-c` or `-m`."""
    server, umask = _server(libraries), os.umask(0)
    os.umask(umask)
    asked = {"arguments": arguments, "folder": str(folder), "environment": dict(environment), "umask": umask}
    print(json.dumps(asked), file=_opened(server.stdin), flush=True)
    return CompletedProcess(arguments, *json.loads(_opened(server.stdout).readline()))
