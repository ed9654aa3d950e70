"""The tables of commands in README.md and docs/command-line.md, from the table of commands and their options."""

from __future__ import annotations

import argparse
import re
import textwrap

import granchain
from app.cli.commands import COMMANDS, module_of


def table_of_commands() -> str:
    """Return the table of README.md: every command, what it does, and the page about it."""
    rows = []
    for name, row in COMMANDS.items():
        page = f" ([docs/{row.page.partition('#')[0]}](docs/{row.page}))" if row.page else ""
        rows.append(f"| `granchain {f'{name} {row.form}'.strip()}` | {_with_marks(row.about)}{page} |")
    return "\n".join(["| command | what it does |", "|---|---|", *rows])


def table_of_json() -> str:
    """Return the table of docs/command-line.md: every command, an example, and where its JSON keys are described."""
    rows = [f"| `{name}` | {_with_marks(row.about)} | `granchain {name} {row.example}` | "
            f"{f'[{name}](#{name})' if '--json' in _help(name) else 'none'} |" for name, row in COMMANDS.items()]
    return "\n".join(["| command | what it does | example | keys |", "|---|---|---|---|", *rows])


#: Functions whose name differs from their command's.
_FUNCTIONS = {"curve": "resonance_curve", "lyapunov": "lyapunov_spectrum", "rotation": "rotation_number",
              "bifurcation-diagram": "bifurcation_diagram", "map": "parameter_map", "accuracy": "work_precision"}
#: An option with which a command does what another function does in Python, by command.
_OPTIONS = {"run": ("run --drive", "drive")}
#: What a command does in Python with another function before the one of its name.
_FUNCTION_BEFORE = {"figure": "`granchain_core.paper.compute`, then "}


def table_of_functions() -> str:
    """Return the table of README.md: the commands with a function, in the order of `granchain --help`."""
    public = {*_FUNCTIONS.values(), *(function for _, function in _OPTIONS.values())}
    unknown = {*_FUNCTIONS, *_OPTIONS} - {*COMMANDS} | public - {*granchain.__all__}
    assert not unknown, f"no command or public function: {unknown}"
    rows = []
    for name in COMMANDS:
        function = _FUNCTIONS.get(name, name)
        if function in granchain.__all__:
            rows.append(f"| `{name}` | {_FUNCTION_BEFORE.get(name, '')}`{function}` |")
        if name in _OPTIONS:
            rows.append("| `{}` | `{}` |".format(*_OPTIONS[name]))
    return "\n".join(["| command | function |", "|---|---|", *rows])


def _with_marks(words: str) -> str:
    """Put the options in a text into backquotes."""
    return re.sub(r"--[\w-]+", r"`\g<0>`", words)


def commands_with_pictures() -> str:
    """Return the list of README.md: every command with the option --picture, in the order of `granchain --help`."""
    drawing = [f"`{name}`" for name in COMMANDS if "--picture" in _help(name)]
    return "\n".join(textwrap.wrap(f"{', '.join(drawing[:-1])} and {drawing[-1]}.", 120))


def _help(command: str) -> str:
    """Return the text of `granchain COMMAND --help` about its options."""
    parser = argparse.ArgumentParser()
    module_of(command).add_options(parser)
    return parser.format_help()
