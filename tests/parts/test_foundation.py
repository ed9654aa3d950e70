"""k and κ at another amplitude: a change is reported where it occurs, and only there."""

from __future__ import annotations

import math

import pytest

from app.cli import main
from app.cli.foundation import kappa_changed_by_amplitude, kappa_changes_along
from app.parts.knobs.foundation import beside_kappa
from granchain_core import scene, settle

RIG = scene("rig")


def printed(*settings: str, capsys: pytest.CaptureFixture[str]) -> str:
    """Return a run's stderr with these settings; its stdout is one JSON object and nothing else."""
    words = [word for setting in settings for word in ("--set", setting)]
    assert main(["run", "rig", "--periods", "0", "--record", "1", "--json", *words]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("{") and out.count("\n") == 1
    return err


def test_an_amplitude_set_alone_is_reported_with_both_kappas(capsys: pytest.CaptureFixture[str]) -> None:
    told = printed("A0=6e-6", capsys=capsys)
    # κ = k/(K√A0): 0.001·√(7/6)
    assert told == "κ was 0.001 before A₀ changed at constant k. It is 0.00108012 now; --set kappa=0.001 keeps it.\n"


@pytest.mark.parametrize("settings", [("A0=6e-6", "kappa=0.001"), ("k=30000", "A0=6e-6"), ("A0=7e-6",), ("D=30",)])
def test_a_change_of_kappa_that_was_requested_is_not_reported(settings: tuple[str, ...],
                                                            capsys: pytest.CaptureFixture[str]) -> None:
    assert "κ" not in printed(*settings, capsys=capsys)


def test_without_a_foundation_no_change_of_kappa_is_reported() -> None:
    sec2 = scene("sec2")
    assert kappa_changed_by_amplitude(sec2, sec2.evolve(A0=1e-6), {"A0"}) == ""
    assert kappa_changes_along(sec2, "A0", "f") == beside_kappa(sec2.evolve(A0=1e-6)) == ""


def test_a_branch_or_map_over_the_amplitude_is_reported() -> None:
    assert "constant k = 32435.6 N/m" in kappa_changes_along(RIG, "f", "A0")
    assert kappa_changes_along(RIG, "f", "D") == kappa_changes_along(RIG, "kappa", "A0") == ""


def test_the_page_shows_the_former_kappa() -> None:
    assert beside_kappa(RIG.evolve(A0=6e-6)) == "κ was 0.001 before A₀ changed at constant k"
    assert beside_kappa(RIG) == beside_kappa(RIG.evolve(A0=6e-6, kappa=0.001)) == ""


def test_the_presets_of_figure_12_are_peak_valley_peak_in_period_1() -> None:
    """Amplitudes are within the paper's 6 to 13 µm, with κ = 0.001; the forces themselves are in docs/lecture.md."""
    found = [scene(name) for name in ("fig12-60", "fig12-90", "fig12-100")]
    assert [(one.f, one.A0) for one in found] == [(60.0, 11e-6), (90.0, 6e-6), (50.0, 13e-6)]
    for one in found:
        assert one.k == pytest.approx(0.001 * one.K * math.sqrt(one.A0), rel=1e-14)
        assert one.reference_overlap == RIG.reference_overlap
    pictures = [settle(one) for one in found]
    assert [(p.regime.name, p.regime.period) for p in pictures] == [("periodic", 1)] * 3
    first, valley, second = (p.run.max_output_force_elastic for p in pictures)
    assert min(first, second) > 2 * valley
