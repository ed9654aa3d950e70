"""After Ctrl-C or SIGTERM at any instant, there is an exit status and a sentence, no traceback, and no process left; a
kill leaves no process either.
"""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tools.kills.processes import ROOT, Command

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="descendants are found in /proc")

SENTENCE = {signal.SIGINT: (130, "Cancelled"), signal.SIGTERM: (143, "Terminated")}
#: Commands that compute for minutes.
LONG = {
    "run": ("run", "rig", "--periods", "1000000", "--record", "1"),
    "curve": ("curve", "sec2", "--from", "100", "--to", "3000", "--points", "50000"),
    "branch": ("branch", "sec2", "--knob", "f", "--from", "340", "--to", "60"),
    "map": ("map", "sec2", "--x", "f=200:3000:500", "--y", "A0=2e-7:1e-5:500:log", "--out", "map.h5"),
    "accuracy": ("accuracy", "rig"),
    "check": ("check", "--quick"),
    "warm": ("warm",),
    "serve": ("serve", "--port", "0"),
}
#: The script `granchain`, as pip writes it, and `python -m app.cli`.
ENTRIES = {"granchain": ("-c", "import sys; from granchain_start import entry; sys.argv[0] = 'granchain'; sys.exit(entry())"),
           "python -m": ("-m", "app.cli")}


@pytest.fixture
def started(tmp_path: Path) -> Iterator[Callable[..., Command]]:
    commands: list[Command] = []

    def start(*words: str, **options: object) -> Command:
        commands.append(Command(*words, folder=tmp_path, **options))
        return commands[-1]

    yield start
    for one in commands:
        one.kill()


def ends_well(command: Command, number: signal.Signals) -> None:
    status, word = SENTENCE[number]
    assert command.end() == status
    said = command.err.splitlines()
    assert said[-1].startswith(word) and said[-1].endswith("."), command.err
    assert [line for line in said if word in line] == [said[-1]]
    assert "Traceback" not in command.err and "Error" not in command.err and "Warning" not in command.err
    assert command.left() == []


#: All commands, with both signals in turn; `python -m tools.kills` tests all pairs at random instants. With compiled
#: kernels, `warm` has nothing to do; the next test ends it while it compiles.
BY_TURNS = [(name, list(SENTENCE)[i % 2]) for i, name in enumerate(LONG) if name != "warm"]


@pytest.mark.parametrize(("name", "number"), BY_TURNS)
def test_a_command_ends_while_it_computes_or_compiles(name: str, number: signal.Signals,
                                                      started: Callable[..., Command]) -> None:
    """A command has loaded everything after less than 1.2 s of processor time. It then computes, or compiles if the
    machine has no kernels yet. `serve` reports when it is ready.
    """
    command = started(*LONG[name])
    if name == "serve":
        assert command.process.stdout is not None and "granchain is at" in command.process.stdout.readline()
    while name != "serve" and command.processor_time() < 1.2:
        assert command.process.poll() is None
        time.sleep(0.05)
    command.send(number, to_all=number is signal.SIGINT)
    ends_well(command, number)


@pytest.mark.parametrize(("name", "number"), list(zip(["run", "check", "warm", "serve"], list(SENTENCE) * 2, strict=True)))
def test_a_command_ends_while_kernels_compile(name: str, number: signal.Signals, started: Callable[..., Command],
                                              tmp_path: Path) -> None:
    command = started(*LONG[name], GRANCHAIN_CACHE=str(tmp_path / "empty"))
    while not list((tmp_path / "empty").rglob("*.nb?")):  # the first kernel is compiled, and the next one is being compiled
        assert command.process.poll() is None
        time.sleep(0.05)
    command.send(number, to_all=number is signal.SIGINT)
    ends_well(command, number)


@pytest.mark.parametrize(("after", "entry"), list(zip([0.0, 0.03, 0.1, 0.2, 0.4, 0.8], list(ENTRIES) * 3, strict=True)))
def test_an_interrupt_in_the_first_second(after: float, entry: str, started: Callable[..., Command]) -> None:
    """It arrives while the program loads, at any time after the signal handlers were installed."""
    command = started(*LONG["run"], program=ENTRIES[entry])
    while not command.listening():
        assert command.process.poll() is None
    time.sleep(after)
    command.send(signal.SIGINT)
    ends_well(command, signal.SIGINT)


def test_the_entry_imports_next_to_nothing_before_it_listens() -> None:
    """Ctrl-C during an import before the handlers are installed would end in Python's own traceback."""
    program = ("import sys\nbefore = set(sys.modules)\nimport app.cli\nprint(sorted(set(sys.modules) - before))\n"
               "from app.cli import ending\nprint(any(name.split('.')[0] in {'numpy', 'numba', 'granchain_core', 'argparse'}"
               " for name in sys.modules))\n")
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["['__future__', 'app', 'app.cli']", "False"]


@pytest.mark.parametrize("name", ["check", "warm", "serve", "map", "branch"])
def test_nothing_is_left_of_a_command_that_is_killed(name: str, started: Callable[..., Command], tmp_path: Path) -> None:
    command = started(*LONG[name], GRANCHAIN_CACHE=str(tmp_path / "empty"))
    time.sleep(1.0)
    while name in ("check", "warm", "serve") and len(command.descendants()) < 2:
        assert command.process.poll() is None
        time.sleep(0.05)
    command.send(signal.SIGKILL)
    assert command.end() == -signal.SIGKILL
    assert command.left() == []
    # Python may print a traceback if a worker was still being started; a frame of granchain in it would be a fault
    assert not re.search(r'File "[^"]*/(granchain_core|app)/', command.err)


def test_the_process_of_hard_cases_ends_with_a_killed_server(started: Callable[..., Command]) -> None:
    program = ("from granchain_core.hard_cases import CASES\nfrom granchain_core.execution.stop import Stop\n"
               "from app.pages.hard_cases.work import CaseProcess\n"
               "for case in CASES:\n    print(case.name, flush=True)\n    list(CaseProcess().measure(case, Stop()))\n")
    command = started(program=("-c", program))
    while not command.descendants():
        assert command.process.poll() is None
        time.sleep(0.05)
    command.send(signal.SIGKILL)
    command.end()
    assert command.left() == []


def test_a_second_signal_ends_a_command_that_ignores_the_first(started: Callable[..., Command],
                                                               tmp_path: Path) -> None:
    """The sentence on stderr says where the finished part is kept."""
    (tmp_path / "out.h5.blocks").mkdir()
    program = ("import time\nfrom app.cli import ending\nending.begin()\nending.note_checkpoints('out.h5.blocks')\n"
               "with ending.asking():\n    print('inside', flush=True)\n    time.sleep(1000)\n")
    command = started(program=("-c", program))
    assert command.process.stdout is not None and command.process.stdout.readline() == "inside\n"
    command.send(signal.SIGTERM)
    time.sleep(0.2)
    assert command.process.poll() is None  # it is given some time to end
    command.send(signal.SIGINT)
    assert command.end() == 143  # the status of the first signal
    assert command.err == "Terminated: finished work is kept in out.h5.blocks; continue with --resume.\n"


def test_a_signal_after_the_result_is_written_says_where_it_is(started: Callable[..., Command], tmp_path: Path) -> None:
    """By then its blocks have been removed, but the table has not been printed yet."""
    program = ("import time\nfrom app.cli import ending\nfrom app.cli.common import unbroken\nending.begin()\n"
               "ending.note_checkpoints('out.h5.blocks')\nwith unbroken('out.h5'):\n    pass\nprint('written', flush=True)\n"
               "time.sleep(1000)\n")
    command = started(program=("-c", program))
    assert command.process.stdout is not None and command.process.stdout.readline() == "written\n"
    command.send(signal.SIGTERM)
    assert command.end() == 143
    assert command.err == "Terminated: the result is in out.h5.\n"


@pytest.mark.parametrize("number", SENTENCE)
def test_a_signal_after_the_end_of_a_command_changes_nothing(number: signal.Signals, started: Callable[..., Command]) -> None:
    """Python takes some time to exit, and its default handlers would end the process with another status."""
    program = ("import atexit, os, time\nfrom app.cli import ending\nending.begin()\n"
               "atexit.register(lambda: (print('leaving', flush=True), time.sleep(0.3)))\n"
               "class Late:\n    def __del__(self, write=os.write, sleep=time.sleep):\n"
               "        write(1, b'almost gone\\n')\n        sleep(0.3)\nlate = Late()\n"
               "raise SystemExit(ending.leave(0))\n")
    command = started(program=("-c", program))
    assert command.process.stdout is not None
    for line in ("leaving\n", "almost gone\n"):
        assert command.process.stdout.readline() == line
        if command.process.poll() is None:
            command.send(number)
    assert command.end() == 0 and command.err == ""


def test_an_ignored_interrupt_stays_ignored(started: Callable[..., Command]) -> None:
    """This is the case in a shell's background jobs."""
    program = ("import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\nfrom app.cli import ending\nending.begin()\n"
               "print(signal.getsignal(signal.SIGINT) is signal.SIG_IGN)\n")
    command = started(program=("-c", program))
    assert command.end() == 0 and command.out == "True\n"
