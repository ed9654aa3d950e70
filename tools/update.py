"""Updates everything that follows from the code and the scenes; run it after a change of either.

    python -m tools.update

- tables in the readme and the docs: `_TABLES` lists them with their pages;
- the table of steps in each recipe docs/add-….md;
- numbers from the code in sentences of the docs (tools/numbers.py);
- a row for every new scene in the test of share links (tools/links.py);
- for every new or changed scene, the largest values that scale its pictures (tools/scales.py) and its picture in the
  gallery (tools/gallery.py).

Tests compare all of them with the output of this program.
"""

from __future__ import annotations

from pathlib import Path

from tools import gallery, links, recipes, scales
from tools.command_tables import commands_with_pictures, table_of_commands, table_of_functions, table_of_json
from tools.dashboard_tables import table_of_messages_of_the_browser, table_of_messages_of_the_server
from tools.generated import with_part
from tools.hard_cases import table_of_hard_cases
from tools.lists import (
    equations,
    list_of_methods,
    table_of_connection_times,
    table_of_drives,
    table_of_former_names,
    table_of_knobs,
    table_of_libraries,
    table_of_metrics,
    table_of_orders,
    table_of_picture_stages,
    table_of_scenes,
    table_of_worker_pools,
    test_command,
)
from tools.map_of_code import table_of_folders, table_of_pages
from tools.marks import (
    table_of_lines_over_a_knob,
    table_of_lines_over_time,
    table_of_regime_marks,
    table_of_special_points,
)
from tools.numba_names import table_of_intrinsics, table_of_numba_names
from tools.numbers import marks, with_numbers
from tools.special_kinds import table_of_kinds, table_of_terms
from tools.thresholds import (
    table_of_attractors,
    table_of_branches,
    table_of_fits,
    table_of_regimes,
    table_of_responses,
    table_of_rotation_numbers,
    table_of_safety_factors,
    table_of_step_sizes,
)

_ROOT = Path(__file__).resolve().parents[1]
_COMMAND = "python -m tools.update"
#: Every table that follows from the code: its page, its name in the page's marks, and the function that writes it.
_TABLES = (
    ("docs/regimes.md", "thresholds", table_of_regimes),
    ("docs/rotation-number.md", "rotation thresholds", table_of_rotation_numbers),
    ("docs/orbits.md", "thresholds", table_of_responses),
    ("docs/branches.md", "kinds of special points", table_of_kinds),
    ("docs/constants.md", "branch constants", table_of_branches),
    ("docs/fit.md", "constants of a fit", table_of_fits),
    ("docs/constants.md", "constants of the search", table_of_attractors),
    ("docs/glossary.md", "special points", table_of_terms),
    ("docs/accuracy.md", "safety factors", table_of_safety_factors),
    ("docs/hard-cases.md", "hard cases", table_of_hard_cases),
    ("docs/method.md", "methods", list_of_methods),
    ("docs/method.md", "orders", table_of_orders),
    ("docs/constants.md", "step sizes", table_of_step_sizes),
    ("docs/model.md", "knobs", table_of_knobs),
    ("README.md", "equations", equations),
    ("README.md", "scenes", table_of_scenes),
    ("README.md", "test command", test_command),
    ("README.md", "commands", table_of_commands),
    ("README.md", "functions", table_of_functions),
    ("docs/command-line.md", "commands", table_of_json),
    ("README.md", "commands with pictures", commands_with_pictures),
    ("docs/scenes.md", "drives", table_of_drives),
    ("docs/marks.md", "lines over a knob", table_of_lines_over_a_knob),
    ("docs/marks.md", "special points", table_of_special_points),
    ("docs/marks.md", "marks of regimes", table_of_regime_marks),
    ("docs/marks.md", "lines over time", table_of_lines_over_time),
    ("docs/libraries.md", "libraries", table_of_libraries),
    ("docs/compiling.md", "names of Numba", table_of_numba_names),
    ("docs/compiling.md", "intrinsics", table_of_intrinsics),
    ("docs/deployment.md", "metrics", table_of_metrics),
    ("docs/python.md", "former names", table_of_former_names),
    ("docs/deployment.md", "stages of a picture", table_of_picture_stages),
    ("docs/design.md", "folders", table_of_folders),
    ("docs/design.md", "pages of the dashboard", table_of_pages),
    ("docs/dashboard.md", "messages of the browser", table_of_messages_of_the_browser),
    ("docs/dashboard.md", "messages of the server", table_of_messages_of_the_server),
    ("docs/dashboard-server.md", "worker pools", table_of_worker_pools),
    ("docs/dashboard-server.md", "times of the connection", table_of_connection_times),
    *recipes.tables(),
)


#: The pages with such tables, and those with numbers from the code in their sentences.
PAGES = tuple(dict.fromkeys([*(page for page, _, _ in _TABLES),
                             *(path.relative_to(_ROOT).as_posix() for path in sorted((_ROOT / "docs").glob("*.md"))
                               if marks(path.read_text(encoding="utf-8")))]))


def pages() -> dict[Path, str]:
    """Return the pages with a table or numbers that follow from the code, with their text as it should be."""
    found: dict[Path, str] = {}
    for page, name, table in _TABLES:
        path = _ROOT / page
        text = found[path] if path in found else path.read_text(encoding="utf-8")
        found[path] = with_part(text, name, _COMMAND, table())
    for path in map(_ROOT.joinpath, PAGES):
        found[path] = with_numbers(found[path] if path in found else path.read_text(encoding="utf-8"))
    return found


def main() -> None:
    """Write everything that is out of date, and print the names of the changed files."""
    texts = {**pages(), links.FILE: links.with_new_scenes()}
    for path, text in texts.items():
        if path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
            print(path.relative_to(_ROOT))
    if names := scales.changed():
        scales.main(names)
    if names := gallery.changed():
        gallery.main(names)


if __name__ == "__main__":
    main()
