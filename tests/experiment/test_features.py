"""The features that the paper states."""

from __future__ import annotations

from granchain_core.experiment import stated_features


def test_the_stated_features_are_the_papers_and_carry_no_force() -> None:
    # Section 3 of the paper: 60 Hz (1:1), 90 Hz (anti, 1:1), 100 Hz (1:2), five repeats each
    found = [(f.frequency, f.kind, f.repeats) for f in stated_features()]
    assert found == [(60.0, "1:1 resonance", 5), (90.0, "1:1 anti-resonance", 5), (100.0, "1:2 resonance", 5)]
    assert [f.is_resonance for f in stated_features()] == [True, False, True]
    assert all("no force is stated" in f.quantity and "figure 6a" in f.source for f in stated_features())
