"""The wheel installs only our own package names, can be built from the files that the Docker builder receives, and
works without the source tree.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from docker_context import ROOT, copy_context, let_through

from granchain_core import __version__

#: A program that calls the hook in hatch_build.py with stand-ins for hatchling, because there is no network to fetch
#: it.
PLACES = """
import sys, types
for name in ("hatchling", "hatchling.builders", "hatchling.builders.hooks", "hatchling.builders.hooks.plugin",
             "hatchling.builders.hooks.plugin.interface"):
    sys.modules[name] = types.ModuleType(name)
sys.modules[name].BuildHookInterface = object
import hatch_build
hook, standard, editable = hatch_build.CustomBuildHook(), {}, {}
hook.root = "."
hook.initialize("standard", standard)
hook.initialize("editable", editable)
assert editable == {}, editable
for here, there in standard["force_include"].items():
    print(here, there)
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the files of a wheel where pip would put them, made from the files that the Docker builder receives.
    """
    source, folder = tmp_path_factory.mktemp("context"), tmp_path_factory.mktemp("wheel")
    copy_context(source)
    said = subprocess.run([sys.executable, "-c", PLACES], cwd=source, capture_output=True, text=True, check=True).stdout
    places = [(name, name) for name in ("granchain", "granchain_core", "granchain_start")]
    places += [(here, there) for here, there in map(str.split, said.splitlines())]
    for here, there in places:
        target = folder / there
        target.parent.mkdir(parents=True, exist_ok=True)
        if (source / here).is_dir():
            shutil.copytree(source / here, target, ignore=shutil.ignore_patterns("*.pyc.*"))
        else:
            shutil.copy(source / here, target)  # hatchling also fails if a file is missing
    return folder


def test_the_citation_and_the_list_of_changes_name_the_version() -> None:
    """The wheel's version is read from granchain_core/version.py."""
    told = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert told["project"]["dynamic"] == ["version"] and (ROOT / told["tool"]["hatch"]["version"]["path"]).is_file()
    assert f"\nversion: {__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\n## [{__version__}]" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_docker_image_gets_only_files_that_the_ignore_file_lets_through() -> None:
    """Unrelated files and Python's leftovers are not sent to the builder."""
    sent = {name: let_through(ROOT / name) for name in (
        "app/server.py", "docs/glossary.md", "docs/model.md", "tests/conftest.py", ".git/config", "app/x.pyc",
        "granchain_core/kernels/__pycache__/x.pyc", "secret")}
    assert [name for name, is_sent in sent.items() if is_sent] == ["app/server.py", "docs/glossary.md"]


def test_the_wheel_has_only_names_that_are_ours_and_runs(wheel: Path) -> None:
    assert {path.name for path in wheel.iterdir()} == {"granchain", "granchain_core", "granchain_app", "granchain_start"}
    assert not (wheel / "granchain_app" / "main.py").exists()
    code = ("import sys; sys.path.insert(0, sys.argv.pop(1)); import granchain_start; status = granchain_start.entry(); "
            "sys.exit(status or int('app' in sys.modules or 'granchain_app' not in sys.modules))")
    ran = subprocess.run([sys.executable, "-c", code, str(wheel), "scenes", "--json"], cwd=wheel, text=True,
                         capture_output=True, check=False)
    assert ran.returncode == 0 and '"sec2"' in ran.stdout, ran.stderr
    code = ("import sys; sys.path.insert(0, sys.argv[1]); import granchain\n"
            "found = granchain.WorkPrecision(granchain.scene('sec2'), 'dop853', 'another', 1e-9)\n"
            "print(granchain.figure(found).height, 'granchain_app.plots.any_result' in sys.modules, 'app' in sys.modules)")
    drawn = subprocess.run([sys.executable, "-c", code, str(wheel)], cwd=wheel, text=True, capture_output=True, check=False)
    assert drawn.stdout == "420 True False\n", drawn.stderr


def test_every_module_of_the_wheel_is_found_under_its_name_there(wheel: Path) -> None:
    """The files read at import are there, and no import, even inside a function, uses the source tree's package name.
    """
    named = [path for path in (wheel / "granchain_app").rglob("*.py")
             if re.search(r"^\s*(from|import) app\b", path.read_text(encoding="utf-8"), re.MULTILINE)]
    assert named == []
    code = ("import sys; sys.path.insert(0, sys.argv[1]); import importlib, pkgutil, granchain_app\n"
            "names = [found.name for found in pkgutil.walk_packages(granchain_app.__path__, 'granchain_app.')]\n"
            "for name in names: importlib.import_module(name)\n"
            "from granchain_app.dashboard import scales; from granchain_app.session import stories\n"
            "from granchain_app.pages.data import page as data; from granchain_app.session import terms\n"
            "assert 'resonance' in terms.definitions()\n"
            "assert scales.FILE.is_file() and data.SAMPLES.is_dir() and stories.FOLDER.is_dir()\n"
            "print(len(names) > 100, 'app' in sys.modules)")
    ran = subprocess.run([sys.executable, "-c", code, str(wheel)], cwd=wheel, text=True, capture_output=True, check=False)
    assert ran.stdout == "True False\n", ran.stderr
