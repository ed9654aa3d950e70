"""The tables of commands in README.md and docs/command-line.md, from the table of commands and their options."""

from __future__ import annotations

import argparse
import re
import textwrap

from app.cli.commands import COMMANDS, module_of


def table_of_commands() -> str:
    """The table of README.md: every command with what it does, and the page about it."""
    rows = []
    for name, row in COMMANDS.items():
        page = f" ([docs/{row.page.partition('#')[0]}](docs/{row.page}))" if row.page else ""
        rows.append(f"| `granchain {f'{name} {row.form}'.strip()}` | {_with_marks(row.about)}{page} |")
    return "\n".join(["| command | what it does |", "|---|---|", *rows])


def table_of_json() -> str:
    """The table of docs/command-line.md: every command, an example, and where the keys of its JSON are."""
    rows = [f"| `{name}` | {_with_marks(row.about)} | `granchain {name} {row.example}` | "
            f"{f'[{name}](#{name})' if '--json' in _help(name) else 'none'} |" for name, row in COMMANDS.items()]
    return "\n".join(["| command | what it does | example | keys |", "|---|---|---|---|", *rows])


def _with_marks(words: str) -> str:
    """Words with their options in backquotes."""
    return re.sub(r"--[\w-]+", r"`\g<0>`", words)


def commands_with_pictures() -> str:
    """The list of README.md: every command that has the option --picture, in the order of `granchain --help`."""
    drawing = [f"`{name}`" for name in COMMANDS if "--picture" in _help(name)]
    return "\n".join(textwrap.wrap(f"{', '.join(drawing[:-1])} and {drawing[-1]}.", 120))


def _help(command: str) -> str:
    """What `granchain COMMAND --help` says of its options."""
    parser = argparse.ArgumentParser()
    module_of(command).add_options(parser)
    return parser.format_help()
