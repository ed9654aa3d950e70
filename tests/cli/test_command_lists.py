"""Every command has an example, which its parser accepts and its help shows, and a hostile command line."""

from __future__ import annotations

import pytest

from app.cli.commands import COMMANDS, parser_for
from granchain_core import BadInput
from tools.hostile.commands import BASES


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_has_an_example(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    row = COMMANDS[command]
    parser_for([command]).parse_args([command, *row.example.split()])
    with pytest.raises(SystemExit):
        parser_for([command]).parse_args([command, "--help"])
    assert f"Example: granchain {command} {row.example}" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("command", COMMANDS)
def test_required_arguments_of_a_command_are_in_its_form(command: str) -> None:
    """The required words of every command are in the table of README.md."""
    for action in parser_for([command]).commands[command]._actions:
        if action.required and action.nargs != "*":
            assert (action.option_strings or [action.metavar])[0] in COMMANDS[command].form.split(), action.dest


@pytest.mark.parametrize("command", COMMANDS)
def test_a_hostile_base_of_every_command_gets_past_the_parser(command: str) -> None:
    """Otherwise, command lines with replaced, dropped, doubled or added words would only test the parser."""
    def taken(base: list[str]) -> bool:
        try:
            parser_for(base).parse_args(base)
        except BadInput:
            return False
        return True

    assert any(taken(base) for base in BASES if base[:1] == [command])
