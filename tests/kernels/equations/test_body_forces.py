"""Forces from outside the chain: all of their terms are called, with the number of the bead on which they act."""

from __future__ import annotations

import ast
import inspect
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.integrate.scaling import ScaledChain, scale_chain
from granchain_core.kernels.compiling.dispatch import TERMS
from granchain_core.kernels.effects.energy_account import EnergyAccount
from granchain_core.kernels.equations import body_forces

pytestmark = pytest.mark.quick

MOTION = sys.modules["granchain_core.kernels.equations.motion"]


@pytest.fixture
def chain() -> ScaledChain:
    return scale_chain(scene("sec2").evolve(N=4))


def numbers(monkeypatch: pytest.MonkeyPatch, module: Any, name: str, answer: int) -> list[int]:
    """Replace a module's term by one that returns its argument `answer`, and list the bead numbers it is called with.
    """
    asked: list[int] = []

    def term(slots: Any, i: int, *values: Any) -> Any:
        asked.append(i)
        return values[answer]

    monkeypatch.setattr(module, name, term)
    return asked


def test_every_term_is_asked_for_each_bead(monkeypatch: pytest.MonkeyPatch, chain: ScaledChain) -> None:
    y, dy, slots = np.zeros(14), np.zeros(14), chain.slots._replace(account=EnergyAccount(1))
    forces = chain.forces()
    of_forces = numbers(monkeypatch, MOTION, "force_on_bead", 0)
    of_powers = numbers(monkeypatch, body_forces, "power_lost_on_bead", 0)
    MOTION.motion(slots, 0.0, 0.0, y, dy, forces)
    assert of_forces == of_powers == [1, 2, 3, 4]
    of_energies = numbers(monkeypatch, MOTION, "stored_on_bead", 0)
    MOTION.stored_energy(slots, y, dy)
    assert of_energies == [1, 2, 3, 4]


def test_the_step_is_that_of_the_strongest_of_unequal_forces(monkeypatch: pytest.MonkeyPatch) -> None:
    """For a force −c_i v_i on beads of equal mass, the largest c_i counts."""
    import granchain_core.integrate.scaling as module

    coefficients = np.array([0.0, 1.0, 7.0, 2.0, 0.0])

    def slope(slots: Any, i: Any, before: Any, u: Any, v: Any, du: Any, du_slope: Any, rate: Any) -> Any:
        return before - du_slope * coefficients[i]

    monkeypatch.setattr(module, "add_force_slope", slope)
    assert scale_chain(scene("sec2").evolve(N=3))._body_rates == (0.0, 7.0)


def calls_in(function: str) -> set[str]:
    """Return the names of the functions that a function of body_forces.py calls."""
    tree = ast.parse(Path(body_forces.__file__).read_text(encoding="utf-8"))
    (body,) = (node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == function)
    return {node.func.id for node in ast.walk(body) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}


def test_every_slope_of_an_effect_is_inserted() -> None:
    """A slope that `add_force_slope` does not call would give the multipliers of another chain, without an error.

    A slope that depends on δv belongs to the trace too.
    """
    slopes = {term.__name__: set(inspect.signature(term.implementations[type(None)]).parameters) for term in TERMS
              if "kernels.effects." in term.__module__ and re.fullmatch(r"add_\w+_slope", term.__name__)}
    assert "add_foundation_slope" in slopes
    assert set(slopes) - calls_in("add_force_slope") == set()
    assert {name for name, values in slopes.items() if "du_slope" in values} - calls_in("add_force_trace") == set()


def test_every_term_of_a_force_outside_the_chain_is_inserted() -> None:
    """The force and the energy of the modules whose slope is a term of `add_force_slope`."""
    modules = {term.__module__ for term in TERMS if term.__name__ in calls_in("add_force_slope")}
    terms = {term.__name__ for term in TERMS if term.__module__ in modules}
    called = set().union(*map(calls_in, ("force_on_bead", "stored_on_bead", "power_lost_on_bead", "add_force_slope")))
    assert modules and terms - called == set()
