"""The text of the Accuracy page, without a browser: methods, rows, references and naive forces."""

from __future__ import annotations

import json

import numpy as np

from app.format import prefixed
from app.pages.accuracy.page import measured_for
from app.pages.accuracy.view import described_methods, described_reference, described_rows, naive_message
from app.plots.theme import THEMES
from granchain_core import scene
from granchain_core.accuracy import Row, WorkPrecision, compared_methods
from granchain_core.accuracy.naive import naive_comparison
from granchain_core.execution.stop import Stop


def test_a_measurement_belongs_to_all_knobs_but_the_accuracy() -> None:
    shown = scene("sec2")
    assert measured_for(shown) == measured_for(shown.evolve(accuracy=1e-9))
    for change in ({"f": 341.0}, {"D": 99.0}, {"k": 1.0}, {"N": 12}, {"tension": "cut"}, {"wall": "rigid"}):
        assert measured_for(shown) != measured_for(shown.evolve(**change))


def test_every_compared_method_is_described() -> None:
    shown = described_methods()
    assert [method["name"] for method in shown] == list(compared_methods())
    assert all(method[key] for method in shown for key in ("title", "order", "restrictions", "reference"))


def test_failed_rows_keep_their_sentence_and_are_json() -> None:
    rows = [Row("rk4", "1 × the default steps", float("inf"), 0.0, 0, 1.0, "It was not done."),
            Row("dop853", "tolerance 1e-6", float("nan"), 0.1, 5, 1e-6), Row("rk4", "", 1e-5, 0.001, 7, 2.0)]
    shown = json.loads(json.dumps(described_rows(rows), allow_nan=False))
    assert [(row["way"], row["failure"]) for row in shown] == [
        ("rk4", "It was not done."), ("dop853", "Its numbers are not finite.")]


def test_the_words_of_the_reference_have_its_agreement() -> None:
    found = WorkPrecision(scene("sec2"), "one", "two")
    assert described_reference(found)["agreement_words"] == "The second reference is computed last."
    found.agreement = 7.1e-12
    assert described_reference(found)["agreement_words"] == "Two independent references agree to 7e-12."
    found.agreement = 0.68
    assert "amplifies every error" in described_reference(found)["agreement_words"]
    found.disagreement = "It was not done."
    assert "The second reference failed: It was not done." in described_reference(found)["agreement_words"]


def test_the_forces_are_one_array_in_which_failures_have_no_row() -> None:
    found = naive_comparison(scene("rig"), Stop())
    message = naive_message(found, THEMES["light"])
    rows = message["values"].reshape(-1, message["columns"])
    factor, letter = prefixed(float(np.abs(found.force).max()))
    assert message["values"].dtype == np.float32 and f"({letter}N)" in json.dumps(message["figure"])
    np.testing.assert_allclose(rows[1], found.force / factor, rtol=1e-6)
    for described, naive in zip(message["drawn"], found.lines, strict=True):
        assert (described["row"] < 0) == bool(naive.failure)
        if not naive.failure:
            np.testing.assert_allclose(rows[described["row"]], naive.force / factor, rtol=1e-6)
