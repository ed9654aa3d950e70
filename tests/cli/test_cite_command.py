"""`granchain cite` names the software, the paper, Hertz, and the source of the scene's damping law."""

from __future__ import annotations

import json

import pytest

from app.cli import main


@pytest.mark.parametrize(("settings", "named"), [
    ([], ["software", "model", "contact"]),
    (["--set", "dissipation=tsuji"], ["software", "model", "contact", "tsuji damping"]),
    (["--set", "dissipation=kuwabara-kono"], ["software", "model", "contact", "kuwabara-kono damping"]),
    (["--set", "dissipation=tsuji", "--set", "D=0"], ["software", "model", "contact"]),
    (["--set", "drive=rest", "--set", "striker=6", "--set", "end=last"], ["software", "model", "contact", "solitary wave"]),
    (["--set", "drive=rest", "--set", "dimer=0.5"], ["software", "model", "contact", "solitary wave", "dimers"]),
])
def test_the_sources_of_a_scenes_effects_are_cited(settings: list[str], named: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cite", "sec2", *settings, "--json"]) == 0
    assert [one["for"] for one in json.loads(capsys.readouterr().out)["citations"]] == named
    assert main(["cite", "sec2", *settings]) == 0
    said = capsys.readouterr().out
    assert "arXiv:1606.09305" in said and len(said.splitlines()) == len(named)


@pytest.mark.parametrize(("scene", "named"), [
    ("impact-train", ["solitary wave", "pulse trains"]), ("impact-impurity", ["solitary wave", "impurities"]),
    ("impact-taper", ["solitary wave", "tapered chains"]), ("precompressed", ["precompressed chains"]),
    ("diode", ["precompressed chains", "acoustic diode"]), ("diode-reverse", ["precompressed chains", "acoustic diode"]),
    ("breather", ["precompressed chains", "dark breathers"]),
])
def test_the_sources_of_the_scenes_beyond_the_paper_are_cited(scene: str, named: list[str],
                                                             capsys: pytest.CaptureFixture[str]) -> None:
    """These are the references of docs/scenes.md for the scenes that reproduce them."""
    assert main(["cite", scene, "--json"]) == 0
    assert [one["for"] for one in json.loads(capsys.readouterr().out)["citations"]][3:] == named
