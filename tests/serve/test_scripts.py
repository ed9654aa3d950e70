"""The JavaScript modules: all imports exist, pages and parts keep to their layers, and nothing else is served."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

import pytest
from listening import Listening
from panel.io.server import ComponentResourceHandler
from tornado.web import HTTPError

from app import scripts
from app.dashboard.layout import Views
from app.parts.figures.result_figure import ResultFigure
from app.parts.figures.streamed_figure import StreamedFigure
from app.parts.toolkit.component import Component
from app.scripts import FILES, address, files_by_name, module
from app.server import Access

APP = Path(scripts.__file__).parent
IMPORT = re.compile(r'^import \{ ([^}]+) \} from "(\./[^"]+|\.\./[^"]+)";$', re.MULTILINE)
EXPORT = re.compile(r"^export (?:async )?(?:const|let|function|class) (\w+)", re.MULTILINE)


def served(url: str) -> Path:
    """Return the file that Panel would send."""
    path = url.removeprefix("components/")
    return Path(ComponentResourceHandler.parse_url_path(ComponentResourceHandler, path))  # type: ignore[arg-type]


def imports(name: str) -> dict[str, set[str]]:
    """Return the addresses from which a module imports, with the names from each."""
    found = IMPORT.findall(FILES[name].read_text(encoding="utf-8"))
    here = posixpath.dirname(address(name))
    return {posixpath.normpath(posixpath.join(here, path)): set(names.split(", ")) for names, path in found}


@pytest.mark.parametrize("name", FILES)
def test_every_import_of_a_script_is_served_and_exported(name: str) -> None:
    source = FILES[name].read_text(encoding="utf-8")
    assert len(imports(name)) == len(re.findall(r"^import\b", source, re.MULTILINE)), "an import of another form"
    for url, names in imports(name).items():
        exported = set(EXPORT.findall(served(url).read_text(encoding="utf-8")))
        assert names <= exported, f"{url} has no {names - exported}"


def test_every_name_that_is_exported_is_used_or_tested_alone() -> None:
    used = {(served(url), one) for name in FILES for url, names in imports(name).items() for one in names}
    exported = {(path, one) for path in FILES.values() for one in EXPORT.findall(path.read_text(encoding="utf-8"))}
    alone = (APP.parent / "tests" / "browser" / "test_scripts_alone.py").read_text(encoding="utf-8")
    assert {one for one in exported - used if one[1] != "render" and not re.search(rf"\b{one[1]}\b", alone)} == set()


def test_a_name_that_is_used_twice_is_refused(tmp_path: Path) -> None:
    for folder in ("one", "other"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "plot.js").touch()
    with pytest.raises(ValueError, match=r"other.plot\.js and .+one.plot\.js have the same name"):
        files_by_name("*.js", tmp_path)


def test_every_component_renders_a_module_of_its_own() -> None:
    assert Views.__name__  # importing it registers every component
    parts = {*Component.__subclasses__(), *StreamedFigure.__subclasses__(), *ResultFigure.__subclasses__()} - {StreamedFigure, ResultFigure}
    rendered = {part._esm for part in parts if part.__module__.startswith("app.")}
    assert rendered == {module(name) for name, path in FILES.items() if "render" in EXPORT.findall(path.read_text(encoding="utf-8"))}


@pytest.mark.parametrize("path", ["scripts.py", "dashboard/controller.py", "../pyproject.toml", "dashboard/dashboard.html"])
def test_no_other_file_is_served(path: str) -> None:
    root = address("shared.js").removesuffix("parts/inline_scripts/shared.js")
    with pytest.raises(HTTPError):
        served(root + path)


def test_the_address_of_a_script_changes_with_its_content() -> None:
    """Files of an earlier version that the browser has cached have other addresses."""
    assert re.fullmatch(r"components/app\.scripts/Scripts_[0-9a-f]{12}/__javascript_modules__/parts/toolkit/svg\.js", address("svg.js"))


def test_a_module_is_found_without_panel_and_kept_by_the_browser_for_good() -> None:
    assert all(scripts.file_at(url.removeprefix("components/")) == served(url) for url in map(address, FILES))
    assert scripts.file_at("app.scripts/Scripts_000000000000/__javascript_modules__/parts/toolkit/svg.js") is None
    assert set(scripts.modules()) == {address(name) for name in FILES} - {address(name) for name in scripts.INLINE_SCRIPTS}
    one = Listening(Access())
    try:
        assert all(f'<link rel="modulepreload" href="{url}">' in one.ask()[2] for url in (address("svg.js"), address("chain.js")))
        assert "immutable" in one.ask("/" + address("svg.js"))[1]["Cache-Control"]
        assert "immutable" not in one.ask("/static/js/bokeh.min.js")[1].get("Cache-Control", "")
    finally:
        one.stop()
