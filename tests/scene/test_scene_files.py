"""docs/scene-file.md: its examples are scenes that run, and every mistake gets one clear sentence."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from granchain_core import BadInput, load, run, save, scene
from granchain_core.scene.files import MOST_BYTES, TABLES, WORDS

PAGE = Path(__file__).resolve().parents[2] / "docs" / "scene-file.md"
TEXT = PAGE.read_text(encoding="utf-8")
EXAMPLES = dict(re.findall(r"New file, `([\w-]+\.toml)`:\n\n```toml\n(.*?)```", TEXT, re.DOTALL))


@pytest.fixture
def files(tmp_path: Path) -> Path:
    """Folder with the page's examples."""
    for name, text in EXAMPLES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_the_dimer_has_the_beads_of_the_page(files: Path) -> None:
    """Two kinds of beads alternate, and each contact combines both: K = 4/3 E* √R*."""
    chain = scene(files / "dimer-chain.toml")
    assert (chain.name, chain.title, chain.N) == ("dimer-chain", "Steel and PTFE, alternating", 10)
    assert chain.masses() == pytest.approx([28.84e-3, 7.71e-3] * 5)
    soft = 1.0 / ((1 - 0.3**2) / 193e9 + (1 - 0.46**2) / 1.46e9)
    assert chain.contact_stiffness()[1] == pytest.approx(4 / 3 * soft * np.sqrt(9.525e-3 / 2))
    assert chain.D == scene("sec2").D and chain.look_at == ""


def test_an_impurity_and_moving_beads_are_those_of_the_page(files: Path) -> None:
    chain = scene(files / "light-sixth.toml")
    assert chain.bead(6).mass == 5e-3 and chain.bead(6).young == 193e9 and chain.bead(5).mass == 28.84e-3
    assert chain.velocities_at_start()[:3] == pytest.approx([0.02, 0.01, 0.0])


def test_place_in_older_files_means_site(files: Path) -> None:
    text = (files / "light-sixth.toml").read_text(encoding="utf-8")
    (files / "older.toml").write_text(text.replace("site = ", "place = "), encoding="utf-8")
    present, older = scene(files / "light-sixth.toml"), scene(files / "older.toml")
    assert (older.impurities, older.start_velocity) == (present.impurities, present.start_velocity)


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_examples_run_and_their_files_know_the_scene(name: str, files: Path) -> None:
    chain = scene(files / name)
    found = run(chain, periods=1, record=1, samples=8)
    assert np.abs(found.displacement).max() > 0.0
    assert load(save(found, files / "a.h5")).scene == chain


def test_the_command_line_takes_a_file(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--periods", "1", "--record", "1", "--samples", "8"]
    assert main(["run", str(files / "taper.toml"), "--set", "f=700", *words]) == 0
    assert capsys.readouterr().out.startswith("taper: ")
    assert main(["run", str(files / "nothing.toml"), *words]) == 2
    assert "nothing.toml: cannot be read (No such file or directory)." in capsys.readouterr().err


def test_a_text_is_never_a_path(files: Path) -> None:
    """A name from a link must not open a file."""
    with pytest.raises(BadInput, match="Unknown scene"):
        scene(str(files / "taper.toml"))


def test_a_file_is_read_anew(files: Path) -> None:
    file = files / "taper.toml"
    assert scene(file).f == 600.0
    file.write_text(EXAMPLES["taper.toml"].replace("600.0", "650.0"), encoding="utf-8")
    assert scene(file).f == 650.0


def test_a_file_needs_no_parent(tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    file.write_text("[chain]\nreference_overlap = 1e-6\npattern = [{ mass = 0.01, radius = 0.006, young = 7e10, poisson = 0.33 }]"
                    "\n[knobs]\nN = 3\nf = 500\nA0 = 1e-6\nD = 20\nkappa = 0.001\n", encoding="utf-8")
    assert (scene(file).N, scene(file).F0, round(scene(file).kappa, 9)) == (3, 0.0, 0.001)


@pytest.mark.parametrize(("text", "said"), [
    ("", "there is no pattern; give it, or a parent that has it."),
    ('parent = "sec3"', "Unknown parent 'sec3'; the nearest is 'sec2'"),
    ('parent = "mine.toml"', "Unknown parent 'mine.toml'"),
    ("parent = 2", "parent must be a text, not '2'."),
    ('[knob]\nf = 2', "Unknown section 'knob'; the nearest is 'knobs'"),
    ("knobs = 3", "[knobs] must be a table, not '3'."),
    ('parent = "sec2"\n[knobs]\ntapper = 2', "Unknown name in [knobs] 'tapper'; the nearest is 'taper'"),
    ('parent = "sec2"\n[knobs]\nf = "400"', "The scene's f must be a number, not '400'."),
    ('parent = "sec2"\n[knobs]\nf = -4', "drive frequency f = -4 Hz is outside 0.1 to 1e+06 Hz"),
    ('parent = "sec2"\n[knobs]\nkappa = -4', "is outside 0 to 100"),
    ('parent = "sec2"\n[knobs]\nk = 1.0\nkappa = 0.1', "[knobs] has k and kappa"),
    ('parent = "sec2"\n[chain]\npattern = []', "The scene's pattern must be a list of at most"),
    ('parent = "sec2"\n[chain]\npattern = 3', "pattern must be a list of tables in braces, not '3'."),
    ('parent = "sec2"\n[chain]\npattern = [{ mas = 1 }]', "Unknown name in pattern 'mas'; the nearest is 'mass'"),
    ('parent = "sec2"\n[chain]\npattern = [{ mass = 1.0 }]', "a bead of pattern has no radius"),
    ('parent = "sec2"\n[chain]\nimpurities = [{ mass = 1.0 }]', "an entry of impurities needs site"),
    ('parent = "sec2"\n[chain]\nimpurities = [{ site = 3, mass = -1.0 }]', "impurities mass must be a finite number above 0"),
    ('parent = "sec2"\n[chain]\nimpurities = [{ place = 30, mass = 1.0 }]', "name bead 30, and its beads are 1 to 11."),
    ('parent = "sec2"\n[chain]\nimpurities = [{ site = 3, place = 3, mass = 1.0 }]', "has site and place, which mean the same"),
    ('parent = "sec2"\n[chain]\nstart_velocity = [{ site = 1 }]', "has no velocity [m/s]."),
    ('parent = "sec2"\n[chain]\nreference_overlap = 0', "reference_overlap must be a finite number above 0"),
    ('parent = "sec2"\n[ranges]\nf = [3.0, 2.0]', "the range of f must be two ascending numbers"),
    ("parent = ", "mine.toml: the text is not TOML; invalid value (at "), ("#" * (MOST_BYTES + 1), f"at most {MOST_BYTES} bytes"),
    ("a = " + "[" * 5000, "is not TOML"),
])
def test_a_mistake_has_one_sentence(text: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(BadInput) as problem:
        scene(file)
    assert str(problem.value).startswith("mine.toml: ") and said in str(problem.value)
    assert "\n" not in str(problem.value)


def test_text_in_another_encoding_and_taken_names_are_refused(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_bytes(b'title = "\xff"')
    with pytest.raises(BadInput, match=r"mine\.toml: is not UTF-8 text\."):
        scene(tmp_path / "mine.toml")
    (tmp_path / "sec2.toml").write_text('parent = "sec2"', encoding="utf-8")
    with pytest.raises(BadInput, match="belongs to a scene of granchain"):
        scene(tmp_path / "sec2.toml")


def test_the_page_names_every_entry_and_the_sentence_about_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert [name for name in (*WORDS, *TABLES, *TABLES["chain"]) if f"`{name}`" not in TEXT and f"`[{name}]`" not in TEXT] == []
    (promised,) = re.findall(r"^taper\.toml: (.*?), …$", TEXT, re.MULTILINE)
    (tmp_path / "taper.toml").write_text('parent = "sec2"\n[knobs]\ntapper = 0.5\n', encoding="utf-8")
    assert main(["run", str(tmp_path / "taper.toml")]) == 2
    assert promised in capsys.readouterr().err
