"""The rig's drive amplitudes are defined in the presets, and every text that names one agrees with its preset."""

from __future__ import annotations

from pathlib import Path

import pytest

from granchain_core import scene
from granchain_core.paper import FIGURES
from granchain_core.paper.computations import MODEL_AMPLITUDES, RIG_AMPLITUDE, STATED_AMPLITUDES, STATES

ROOT = Path(__file__).resolve().parents[2]
#: Amplitudes of the presets [µm], as written in texts.
RIG, AT_60, AT_90, AT_50 = (f"{1e6 * scene(name).A0:g}" for name in ("rig", *STATES.values()))
MODELLED = [f"{1e6 * amplitude:g}" for amplitude in MODEL_AMPLITUDES]
#: Phrases that each text must contain; line breaks count as spaces.
NAMED = {
    "docs/paper.md": (f"form peak, valley, peak: {AT_60}, {AT_90} and {AT_50} µm", f"at {RIG} µm the broad high region",
                      f"At {RIG} µm, the model has *no* anti-resonance"),
    "assets/paper/statements.toml": (
        f"with a constant {', '.join(MODELLED[:-1])} and {MODELLED[-1]} µm:",
        f"{RIG} µm is V0 =", f"with a constant {RIG} µm:", f"kN/m at {MODELLED[0]} µm and **44.2** at {MODELLED[-1]} µm",
        f"N with {AT_60} µm, **6.55** N with {AT_90} µm, **15.18** N with {AT_50} µm",
        f"100 Hz: with {RIG} and with 10 µm", f"with {AT_50} µm the motion is **chaotic**. 50 Hz with {AT_50} µm:",
        f"{AT_50} µm at 50 Hz and **6.5** µm at 100 Hz"),
    "assets/scenes/fig12-60.toml": (f"first peak, at {AT_60} µm:", f"At {RIG} µm the same chain"),
    "assets/scenes/fig12-90.toml": (f"The valley, at {AT_90} µm:", f"move A0 alone to {RIG} µm"),
    "assets/scenes/fig12-100.toml": (f"second peak, at {AT_50} µm:", f"is chaotic with {AT_50} µm, and period 1 with {RIG} and"),
}


@pytest.mark.parametrize("name", NAMED)
def test_a_text_names_the_amplitudes_of_the_presets(name: str) -> None:
    text = " ".join((ROOT / name).read_text(encoding="utf-8").split())
    assert [words for words in NAMED[name] if words not in text] == []


def test_figures_are_drawn_with_the_amplitudes_of_the_presets() -> None:
    low, middle, high = STATED_AMPLITUDES
    assert low < middle == RIG_AMPLITUDE < high
    assert (MODELLED, len(MODELLED)) == (sorted({AT_60, AT_90, AT_50, f"{1e6 * high:g}"}, key=float), 4)


def test_captions_name_the_amplitudes_of_the_presets() -> None:
    """They agree word for word; the caption of figure 1 gives the amplitude of section 2 in µm and relative to a bead.
    """
    assert f"at a constant {RIG} µm" in FIGURES["6"].caption
    for number in ("7", "10", "12"):
        assert f"{AT_60} µm at 60 Hz, {AT_90} µm at 90 Hz, and for the paper's 100 Hz {AT_50} µm at 50 Hz" in FIGURES[number].caption
    assert "four constant amplitudes" in FIGURES["9"].caption
    chain = scene("sec2")
    assert f"{1e6 * chain.A0:g} µm, is 1/{2.0 * chain.bead(1).radius / chain.A0:,.0f} of a bead's diameter" in FIGURES["1"].caption
