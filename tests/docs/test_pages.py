"""Files, commands, names and examples in README and docs exist, parse and run."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest
from documents import PAGES, ROOT, blocks, commands

from app import cli
from app.cli.commands import parser_for
from granchain_core import BadInput, scene, scene_names
from granchain_core.scene.quantities import QUANTITIES

MODEL, LECTURE = ROOT / "docs" / "model.md", ROOT / "docs" / "lecture.md"
_ROWS = re.findall(r"^\| `granchain (run [^`]+)` \| ([\d.]+) \| ([^|]+) \|$", LECTURE.read_text("utf-8"), re.MULTILINE)
_FOLDERS = "(?:granchain|granchain_core|app|assets|tests|tools|docs)"
_COMMANDS = sorted({command for page in PAGES for command in commands(page)})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_and_named_files_exist(page: Path):
    """The target of every relative link and every path in backquotes exists, or the page writes it."""
    text = page.read_text(encoding="utf-8")
    files = [Path(block.path) for block in blocks(page) if block.is_new_file]
    made = {str(path) for file in files for path in (file, file.parent)}
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", text):
        assert (page.parent / target).exists(), target
    for name in re.findall(rf"`({_FOLDERS}/[\w./-]+)`", text):
        assert name in made or (ROOT / name).exists(), name


def headings(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as web views of repositories form them."""
    found = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in found}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_to_headings_lead_to_one(page: Path):
    for target, anchor in re.findall(r"\]\(([\w./-]*)#([\w-]+)\)", page.read_text(encoding="utf-8")):
        assert anchor in headings(page.parent / target if target else page), f"{target}#{anchor}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_named_in_short_exist(page: Path):
    """A file that a page names without the top folder is in the core or in the app.

    A bare name is unique there, or the table gives its folder: in its heading, or at the beginning of the row.
    """
    tops, head = [ROOT / "granchain_core", ROOT / "app"], ""
    for line in page.read_text(encoding="utf-8").splitlines():
        if named := re.match(r"\| module of `([\w/]+)` \|", line):
            head = named[1]
        elif not line.startswith("|"):
            head = ""
        row = re.match(r"\| `([\w/]+)` \|", line)
        for name in re.findall(r"`([\w./-]+\.(?:py|js|css))`", line):
            if re.match(f"{_FOLDERS}/", name):
                continue
            places = [place / (row[1] if row else head) / name for place in (ROOT, *tops)]
            found = [top / name for top in tops if (top / name).exists()] or [p for top in tops for p in top.rglob(name)]
            assert any(place.exists() for place in places) or len(found) == 1, f"{name}: {len(found)} files"


def test_files_named_in_the_source_exist():
    """Files of the project that are named in docstrings and comments exist."""
    lost = [f"{path.relative_to(ROOT)}: {name}" for folder in ("granchain_core", "app", "tests", "tools")
            for path in sorted((ROOT / folder).rglob("*.py"))
            for name in re.findall(rf"\b({_FOLDERS}/[\w./-]+\.(?:py|md|npz|css|js))\b", path.read_text(encoding="utf-8"))
            # except those that docs/add-an-effect.md and docs/add-a-command.md write
            if not (ROOT / name).exists() and not name.endswith(("test_drag.py", "test_quadratic_drag.py", "test_cubic_spring.py",
                                                                "test_beads.py"))]
    assert lost == []


def test_files_named_by_their_place_in_a_package_exist():
    """This is about names that begin with a package, for example `flow/tangent.py` in a file of granchain_core."""
    lost = []
    for top in ("granchain_core", "app"):
        for path in sorted((ROOT / top).rglob("*.py")):
            for name in re.findall(r"(?<![\w./-])((?:[a-z_0-9]+/)+[a-z_0-9]+\.(?:py|js|css))\b", path.read_text(encoding="utf-8")):
                places = [ROOT, ROOT / "granchain_core", ROOT / "app", *path.parents]
                if not any((place / name).exists() for place in places):
                    lost.append(f"{path.relative_to(ROOT)}: {name}")
    assert lost == []


def test_modules_named_in_the_docs_can_be_found():
    """A dotted name, e.g. `granchain_core.virtual_experiment`, is a module or a name in one."""
    lost = []
    for page in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]:
        for name in re.findall(r"`((?:granchain_core|app)(?:\.[a-z_0-9]+)+)", page.read_text(encoding="utf-8")):
            module = ROOT.joinpath(*name.split("."))
            owner = ROOT.joinpath(*name.split(".")[:-1])
            found = module.is_dir() or module.with_suffix(".py").exists()
            source = owner / "__init__.py" if owner.is_dir() else owner.with_suffix(".py")
            if not found and not (source.exists() and name.rpartition(".")[2] in source.read_text(encoding="utf-8")):
                lost.append(f"{page.name}: {name}")
    assert lost == []


def test_the_glossary_and_the_words_of_the_code_name_a_place_for_every_term():
    """Each row has a term, its meaning, and at least one file or page; no term is on both pages."""
    text = "".join((ROOT / "docs" / f"{page}.md").read_text("utf-8") for page in ("glossary", "words-of-the-code"))
    rows = re.findall(r"^\| (?!symbol|---)(.+) \|$", text, re.MULTILINE)
    cells = [re.split(r"(?<!\\) ?\| ", row) for row in rows]
    assert all(len(row) == 4 and row[1] and row[2] and re.search(r"[\w/]+\.(py|md)", row[3]) for row in cells)
    terms = [row[1] for row in cells]
    assert len(set(terms)) == len(terms)


def test_the_file_of_a_term_of_the_web_has_the_word():
    """Otherwise the row of a term that has moved to another file would be outdated."""
    section = (ROOT / "docs" / "words-of-the-code.md").read_text("utf-8").partition("## Web and server")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| [^|]+ \| ([^|]+) \| [^|]+ \| ([^|]+) \|$", section, re.MULTILINE)[1:]
    assert len(rows) > 12
    for term, place in rows:
        text = (ROOT / re.findall(r"`(app/[\w/]+\.py)`", place)[0]).read_text("utf-8").lower()
        assert any(word in text for word in re.findall(r"[a-z]{4,}", term)), term


@pytest.mark.parametrize("command", _COMMANDS)
def test_commands_parse_and_their_scenes_and_knobs_exist(command: str):
    """The parser accepts them, and the scene accepts their knobs."""
    words = shlex.split(command)[1:]
    parsed = parser_for(words).parse_args(words)
    # docs/add-an-effect.md adds the scene, docs/add-a-damping-law.md the law, and their tests run them
    if "scene" in parsed and parsed.scene != "drag" and "dissipation=three-quarters" not in getattr(parsed, "set", ()):
        names = parsed.scene if isinstance(parsed.scene, list) else [parsed.scene]
        changes = dict(setting.split("=") for setting in getattr(parsed, "set", ()))
        if changes.get("f") == "13OO":  # the readme's wrong value
            with pytest.raises(BadInput, match="13OO"):
                scene(parsed.scene).evolve(**changes)
        else:
            for name in names:
                scene(name).evolve(**changes)


@pytest.mark.parametrize(("command", "force", "regime"), _ROWS, ids=[row[0] for row in _ROWS])
def test_the_numbers_of_the_lecture_page(command: str, force: str, regime: str, capsys: pytest.CaptureFixture[str]):
    """The commands in docs/lecture.md give the numbers in their rows, to the printed digits."""
    assert cli.main([*shlex.split(command), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    half_a_digit = 0.5 * 10.0 ** -len(force.partition(".")[2])
    assert told["max_output_force_elastic"] == pytest.approx(float(force), abs=half_a_digit)
    assert f"period {told['period']}" == regime.strip()


def test_the_lecture_page_has_rows():
    assert _ROWS


@pytest.mark.parametrize("page", [ROOT / "README.md", LECTURE, ROOT / "docs" / "python.md", ROOT / "docs" / "fit.md",
                                  ROOT / "docs" / "parameter-map.md", ROOT / "docs" / "curve.md", ROOT / "docs" / "orbits.md"], ids=lambda page: page.name)
def test_python_examples_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """All Python blocks of a page run one after the other in an empty folder."""
    code = "\n".join(block.text for block in blocks(page) if block.language == "python")
    monkeypatch.chdir(tmp_path)
    exec(compile(code, page.name, "exec"), {"__name__": "__main__"})
    promised = re.findall(r"^print\(.*\)\s+# (.+)$", code, re.MULTILINE)
    printed = capsys.readouterr().out.splitlines()
    assert promised
    for text in promised:
        assert text.split(":")[0] in printed, (text, printed)


def test_a_transformed_time_is_s_in_the_flow_and_xi_in_dop853_root():
    """They are one term with two variables, as in docs/glossary.md; former names are used only in labels of files."""
    kernels = ROOT / "granchain_core" / "kernels"
    pages = [ROOT / "docs" / f"{name}.md" for name in ("orbits", "branches", "method", "design")]
    files = {path: path.read_text("utf-8")
             for folder in ("flow", "dop853_root") for path in (kernels / folder).glob("*.py")}
    assert [path.name for path, text in files.items() if "ξ" in text and path.parent.name == "flow"] == []
    texts = {**files, **{page: page.read_text("utf-8") for page in pages}}
    former = re.compile("substitut|regularised time", re.IGNORECASE)
    assert [path.name for path, text in texts.items() if former.search(text)] == []


def test_the_commands_of_the_readme_make_their_own_environment():
    """One command opens the dashboard, and one runs all tests as .ci/run does; each is a single line to copy."""
    shells = [block.text for block in blocks(ROOT / "README.md") if block.language == "sh"]
    assert len(shells) == 2
    assert all(text.count("\n") == 1 and text.startswith("python3 -m venv .venv && ") for text in shells)
    assert "granchain serve" in shells[0] and "-m pytest" in shells[1]
    assert len((ROOT / ".ci" / "test-command").read_text("utf-8").splitlines()) == 2
    assert "<.ci/test-command" in (ROOT / ".ci" / "run").read_text("utf-8")


def test_every_scene_is_in_the_readme_and_every_knob_in_the_model():
    readme, model = (ROOT / "README.md").read_text("utf-8"), MODEL.read_text("utf-8")
    assert [name for name in scene_names() if f"`{name}`" not in readme] == []
    assert [q.symbol for q in QUANTITIES.values() if q.symbol and q.symbol != "ε" and q.symbol not in model] == []


def test_dockerfile_has_a_pinned_base_and_copies_what_the_ignore_file_lets_through():
    """A file that .dockerignore excludes cannot be copied."""
    allowed = {line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")}
    docker = (ROOT / "Dockerfile").read_text()
    base, *stages = re.findall(r"^(?:ARG BASE=|FROM )(\S+)", docker, re.MULTILINE)
    assert re.fullmatch(r"python:\d\.\d+-slim@sha256:[0-9a-f]{64}", base) and set(stages) == {"${BASE}"}
    copied = {word for line in re.findall(r"^COPY (?!--from)(.+) \S+$", docker, re.MULTILINE) for word in line.split()}
    assert copied == allowed and all((ROOT / name).exists() for name in copied)
    arguments = json.loads(re.sub(r"\\\n\s*", "", docker.split("ENTRYPOINT ")[1]))
    assert parser_for(arguments[1:]).parse_args(arguments[1:]).address == "0.0.0.0"


def test_the_comparison_with_other_programs_is_that_of_the_tables():
    """Ratios to the times of dop853-root agree with the single run in the table and with the second machine's tables.
    """
    text = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
    sentence = " ".join(text.partition("The fastest other program takes ")[2].partition("## The step")[0].split())
    single = re.match(r"([\d.]+) times as long at 1e-8 and ([\d.]+) times at 1e-10 in this run", sentence)
    tables = re.search(r"it is ([\d.]+) and ([\d.]+) times", sentence)
    assert single is not None and tables is not None
    section = text.split("\n## ")[2]
    for place, error in enumerate(("1e-8", "1e-10"), 1):
        row = re.search(rf"^\| {error} \|(.+)\|$", text.partition("| error | dop853-root |")[2], re.MULTILINE)
        assert row is not None
        times = [float(ms) for ms in re.findall(r"([\d.]+) ms", row[1])]
        ours, others = times[0], times[3:]  # after dop853-root come rk4-split and dop853, which are granchain's too
        assert float(single[place]) == pytest.approx(min(others) / ours, abs=0.051)
        table = section.partition(f"Trajectory at error {error.replace('e-8', 'e-08')}\n")[2].partition("\n\n")[0]
        medians = {line.split("  ")[0]: float(re.findall(r"([\d.]+) ms", line)[0]) for line in table.splitlines()[3:]
                   if re.search(r"  w  .*[\d.]+ ms", line)}
        least = min(ms for name, ms in medians.items() if not name.startswith("granchain"))
        assert float(tables[place]) == pytest.approx(least / medians["granchain dop853-root"], abs=0.051)
