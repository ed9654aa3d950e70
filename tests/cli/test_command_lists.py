"""Where the commands are listed, each of them is: in the readme, and in the hostile command lines."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.cli.commands import COMMANDS, parser_for
from granchain_core import BadInput
from tools.hostile.commands import BASES

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


def test_the_readmes_table_has_every_command() -> None:
    """A row begins with `granchain NAME …`, and may go on with more names in backquotes."""
    rows = re.findall(r"^\| (`granchain \w.*?) \| ", README, re.MULTILINE)
    named = [re.sub("^granchain ", "", words).split()[0] for row in rows for words in re.findall("`(.+?)`", row)]
    assert sorted(named) == sorted(COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_hostile_base_of_every_command_gets_past_the_parser(command: str) -> None:
    """Otherwise only the parser would be tested with words that are replaced, dropped, doubled or added."""
    def taken(base: list[str]) -> bool:
        try:
            parser_for(base).parse_args(base)
        except BadInput:
            return False
        return True

    assert any(taken(base) for base in BASES if base[:1] == [command])
