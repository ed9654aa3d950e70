"""The Analysis page's requests to the core, its refusals, and the agreement with its command."""

from __future__ import annotations

import json
import shlex

import numpy as np
import pytest

from app.cli import main
from app.cli.commands import parser_for
from app.pages.analysis.questions import (
    MOST_BEADS,
    QUESTIONS,
    Plan,
    chosen_fields,
    offered_fields,
    planned,
    question_of,
    question_text,
    read_question,
)
from app.plots.theme import THEMES
from granchain_core import BadInput, Stop, scene

#: A chain that settles quickly to one point.
CHAIN = scene("sec2").evolve(N=2, f=2000.0)
#: Small values for all fields.
SMALL = {"spectrum": {"force": "input"}, "lyapunov": {"periods": "40"},
         "strobes": {"from": "1990", "to": "2010", "values": "3", "keep": "4", "bead": "2"},
         "basins": {"x": "u1", "y": "v2", "starts": "3"}}


def plan_of(name: str, **changes: str) -> Plan:
    """Return a small plan for a question, with some fields changed."""
    return planned(question_of(name), CHAIN, {**SMALL[name], **changes})


@pytest.mark.parametrize("name", QUESTIONS)
def test_the_printed_command_computes_the_same(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    plan, reports = plan_of(name), [0.0]
    found = plan.compute(Stop(), reports.append)
    assert reports == sorted(reports)
    program, *words = shlex.split(plan.command)
    assert program == "granchain" and main([*words, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    here, there = {
        "spectrum": lambda: (found.amplitude, answer["amplitude"]),
        "lyapunov": lambda: (found.exponents, answer["exponents"]),
        "strobes": lambda: ([point.strobes[:, 0, 1] for point in found.points], answer["displacement"]),
        "basins": lambda: (found.number, answer["number"]),
    }[name]()
    np.testing.assert_array_equal(here, there)
    assert found.summary() and plan.draw(found, THEMES["dark"])


@pytest.mark.parametrize("name", QUESTIONS)
def test_offered_values_can_be_computed(name: str) -> None:
    for chain in (CHAIN, scene("rig"), scene("impact")):
        offered = {field.name: field.value for field in QUESTIONS[name].fields(chain)}
        if name != "strobes" or chain.f > 0.0:  # there is no range of f around 0
            program, *words = shlex.split(planned(QUESTIONS[name], chain, offered).command)
            assert program == "granchain" and "scene" in parser_for(words).parse_args(words)


@pytest.mark.parametrize(("name", "changes", "sentence"), [
    ("spectrum", {"force": "none"}, "force"),
    ("lyapunov", {"periods": "1e9"}, "not a whole number from 20 to 2000"),
    ("lyapunov", {"periods": "2001"}, "drive periods = 2001"),
    ("strobes", {"knob": "self"}, "knob"),
    ("strobes", {"from": "nan"}, "is not a number"),
    ("strobes", {"from": "9", "to": "8"}, "must be the smaller"),
    ("strobes", {"from": "-1", "to": "8"}, "f"),
    ("strobes", {"bead": "3"}, "bead = 3"),
    ("strobes", {"values": "١٢"}, "not a whole number"),
    ("basins", {"x": "v2"}, "both v2"),
    ("basins", {"x": "u3"}, "u3"),
    ("basins", {"starts": "41"}, "starts along each = 41"),
])
def test_invalid_values_are_refused_in_a_sentence(name: str, changes: dict[str, str], sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        plan_of(name, **changes)


def test_malformed_messages_are_refused() -> None:
    for other in ("self", None, 3, ["spectrum"]):
        with pytest.raises(BadInput, match="question"):
            question_of(other)
    with pytest.raises(BadInput, match="N = 301"):
        planned(question_of("basins"), CHAIN.evolve(N=MOST_BEADS + 1), {})
    messages: tuple[object, ...] = (None, [], "x", {"starts": None}, {"starts": {"a": 1}})
    for values in messages:
        try:
            planned(question_of("basins"), CHAIN, values)
        except BadInput as refused:
            assert "starts along each" in str(refused)


@pytest.mark.parametrize("name", QUESTIONS)
def test_a_link_keeps_chosen_values(name: str) -> None:
    question = question_of(name)
    fields = chosen_fields(question, CHAIN, SMALL[name])
    assert {field.name: field.value for field in fields}.items() >= SMALL[name].items()
    assert read_question(question_text(question, fields), CHAIN) == (question, fields)
    assert read_question(question_text(question), CHAIN) == (question, question.fields(CHAIN))


def test_a_chosen_value_stays_while_the_knobs_move_if_it_can() -> None:
    basins = question_of("basins")
    chosen = chosen_fields(basins, CHAIN, {"x": "v2", "starts": "31"})
    longer = {field.name: field.value for field in offered_fields(basins, CHAIN.evolve(N=3, A0=1e-6), chosen)}
    assert (longer["x"], longer["starts"]) == ("v2", "31")
    assert longer["x to"] == {field.name: field.value for field in basins.fields(CHAIN.evolve(A0=1e-6))}["x to"]
    shorter = {field.name: field.value for field in offered_fields(basins, CHAIN.evolve(N=1), chosen)}
    assert (shorter["x"], shorter["starts"]) == ("u1", "31")


@pytest.mark.parametrize(("text", "sentence"), [
    ("self", "Unknown question 'self'"), ("strobes?self=1", "Unknown field 'self'"), ("strobes?knob=self", "Unknown knob 'self'"),
    ("basins?x=u9", "Unknown x 'u9'"), ("?", "Unknown question ''"), ("strobes?" + 40 * "9" + "=1", "Unknown field '9999")])
def test_a_question_of_a_damaged_link_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        read_question(text, CHAIN)
