"""Hostile command lines: valid ones of all commands in which some words are replaced, dropped, doubled or added.

Every command line must end with one of the contract's statuses: 0, 2 with one printable sentence on stderr and nothing
on stdout, or 3. They run one after another in a child process, which saves the second that Python and its libraries
take to start. A child that does not answer in time is killed, and its command line is listed.
"""

from __future__ import annotations

import contextlib
import io
import json
import multiprocessing
import os
import random
import tempfile
import traceback
from collections import Counter
from multiprocessing.connection import Connection
from pathlib import Path

from app.cli.commands import COMMANDS

from .values import text

_SMALL = "--set N=2 --set f=3000 --set accuracy=1e-3"
#: Each ends within seconds as written, and also with a word missing: the longest, `check`, `accuracy` and `serve`, have
#: a word that is refused after parsing. None can harm a file outside its folder.
_WRITTEN = tuple(line.split() for line in (
    f"run sec2 {_SMALL} --periods 0 --record 1 --samples 4 --json",
    f"run sec2 {_SMALL} --periods 2 --record 1 --samples 8 --out run.h5 --explain",
    f"run sec2 {_SMALL} --drive burst=3000:2:0.001 --json",
    f"curve sec2 {_SMALL} --from 2900 --to 3000 --points 2 --json",
    f"curve sec2 {_SMALL} --from 2900 --to 3000 --points 2 --start up --out curve.h5",
    f"orbit sec2 {_SMALL} --json",
    f"branch sec2 {_SMALL} --knob f --from 2990 --to 3000 --json",
    f"map sec2 {_SMALL} --x f=2900:3000:2 --y A0=1e-7:2e-7:2 --out map.h5",
    f"observe sec2 {_SMALL} --input force.csv --json",
    f"spectrum sec2 {_SMALL} --json",
    f"lyapunov sec2 {_SMALL} --periods 20 --json",
    f"rotation sec2 {_SMALL} --json",
    f"bifurcation-diagram sec2 {_SMALL} --over f=2990:3000:2 --keep 4 --json",
    f"attractors sec2 {_SMALL} --random-states 1 --json",
    f"basins sec2 {_SMALL} --x u1=0:2e-7:2 --y v1=0:1e-3:2 --json",
    f"virtual sec2 {_SMALL} --periods 2 --noise 0.01 --out virtual.csv",
    f"fit sec2 {_SMALL} --data curve.csv --free D=100:110 --error 0.03 --design 4 --no-intervals --json",
    "accuracy sec2 --set N=1 --set f=3000 --picture refused.png", "check --quick --picture refused.png",
    "warm nowhere neither", "serve --port 70000 --address 256.1.1.1",
    "pulse impact --set N=4 --json", "bands precompressed --json", "scenes --json", "cite sec2 --json",
    "figure 5 --out five.csv",
    "check --quack --quock", "accuracy sec2 --set N=zwei --set f=lots", "lyapunov sec2 --set N=0 --set D=-1",
    "basins sec2 --set N=0 --set D=-1", "serve --port 0x10 --address 256.1.1.1 --most-visitors 0",
    "--help", "run --help", "nonsense", ""))
#: These, and the examples of the commands not among them, so that each command has a line that the parser accepts.
BASES = (*_WRITTEN, *([name, *row.example.split()] for name, row in COMMANDS.items()
                      if name not in {base[0] for base in _WRITTEN if base}))
_OPTIONS = sorted({word for base in BASES for word in base if word.startswith("--")} | {
    "--resume", "--budget", "--method", "--period", "--observer", "--scheduler", "--threads", "--amplitude", "--picture", "--column"})
_FILES = {
    "force.csv": "time_s,input_force_N\n" + "".join(f"{20 * i}e-6,{min(i, 50 - i)}e-2\n" for i in range(51)),
    "curve.csv": "frequency_Hz,max_output_force_N\n2900,0.1\n2950,0.1\n3000,0.1\n",
}


def drawn(rng: random.Random) -> list[str]:
    """Draw a hostile command line."""
    words = list(rng.choice(BASES))
    for _ in range(rng.randrange(1, 4)):
        place = rng.randrange(len(words) + 1)
        change = rng.randrange(6)
        if change < 2 and place < len(words):
            words[place] = text(rng)
        elif change == 2 and place < len(words):
            name, given, _ = words[place].partition("=")
            words[place] = f"{name}={text(rng)}" if given else text(rng)
        elif change == 3 and place < len(words):
            del words[place]
        elif change == 4 and place < len(words):
            words[place:place] = words[place:place + rng.randrange(1, 3)]
        else:
            words[place:place] = [rng.choice(_OPTIONS), text(rng)][:rng.randrange(1, 3)]
    return [word.replace("\0", "") for word in words]


def faults(words: list[str], status: object, out: str, err: str) -> list[str]:
    """Return what is wrong with the way in which a command line ended."""
    found = []
    if status not in (0, 2, 3):
        found.append(f"status {status}")
    if "Traceback" in out + err:
        found.append("traceback")
    if status == 2 and (out.strip() or len(err.strip().splitlines()) != 1) and not _is_object(out):
        found.append("not one sentence")
    if "--json" in words and status == 0 and "--help" not in words and not _is_object(out):
        found.append("not one JSON object")
    if status != 0 and any(not (letter.isprintable() or letter == "\n") for letter in err):
        found.append("unprintable")
    return found


def _is_object(out: str) -> bool:
    def refuse(constant: str) -> float:
        raise ValueError(constant)

    try:
        return isinstance(json.loads(out, parse_constant=refuse), dict)
    except ValueError:
        return False


def _serve(pipe: Connection, folder: str) -> None:
    from app.cli import main

    os.chdir(folder)
    while (words := pipe.recv()) is not None:
        out, err = io.StringIO(), io.StringIO()
        status: object
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                status = main(words)
            except SystemExit as end:
                status = end.code or 0
            except BaseException:
                status = "escaped"
                traceback.print_exc()
        pipe.send((status, out.getvalue(), err.getvalue()))


class Child:
    """A process in which command lines run; it is replaced when one of them does not end."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._start()

    def _start(self) -> None:
        for name, content in _FILES.items():
            (self._folder / name).write_text(content, encoding="utf-8")
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, str(self._folder)))
        self._process.start()
        theirs.close()

    def run(self, words: list[str], seconds: float) -> tuple[object, str, str] | None:
        """Run a command line; return status ("died" if it did), stdout and stderr; None if it did not end."""
        self._pipe.send(words)
        try:
            if self._pipe.poll(seconds):
                found: tuple[object, str, str] = self._pipe.recv()
                return found
            ended = None
        except EOFError:
            ended = ("died", "", "")
        self.close()
        self._start()
        return ended

    def close(self) -> None:
        """Kill the process."""
        self._process.kill()
        self._process.join()


def run(count: int, seed: int, seconds: float) -> int:
    """Run `count` command lines, print those that ended wrongly and a summary; return the number of faults."""
    rng, ends, wrong = random.Random(seed), Counter[str](), Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        child = Child(Path(folder))
        for _ in range(count):
            words = drawn(rng)
            found = child.run(words, seconds)
            if found is None:
                ends["still computing"] += 1
                print(f"after {seconds:g} s: {words!r:.400}", flush=True)
                continue
            status, out, err = found
            ends[str(status)] += 1
            for fault in faults(words, status, out, err):
                wrong[fault] += 1
                print(f"{fault}: {words!r:.600}\n    {out[-300:]!r}\n    {err[-900:]!r}", flush=True)
        child.close()
    print(f"\n{count} command lines, seed {seed}. Ends: {dict(ends)}. Wrong: {dict(wrong) or 'none'}")
    return sum(wrong.values())
