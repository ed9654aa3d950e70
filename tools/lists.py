"""Lists of the docs that follow from tables in the code.

They are knobs (docs/model.md), methods (docs/method.md), equations, scenes and the command that runs all tests
(README.md), drives by a formula (docs/scenes.md), library internals in use (docs/libraries.md), metrics
(docs/deployment.md), former names (docs/python.md), worker pools and connection times
(docs/dashboard-server.md).
"""

from __future__ import annotations

import math
import re
import textwrap
from pathlib import Path

from app import former_names as own
from app import library_internals
from app.former_names import FormerMetric, former_metric
from app.serve.computing.priorities import ADDED_NICENESS
from app.serve.computing.worker_pools import POOLS
from app.serve.monitoring.metrics import HISTOGRAMS, METRICS, STAGE_TIMES, STAGES
from app.server import add_shared_metrics
from granchain_core import former_names as core
from granchain_core import scene, scene_names
from granchain_core.integrate import METHODS
from granchain_core.prescribed_drive.formulas import FORMULAS
from granchain_core.scene.quantities import QUANTITIES, Quantity
from tools.connection_times import connection_times
from tools.thresholds import printed

ROOT = Path(__file__).resolve().parents[1]


def table_of_knobs() -> str:
    """Return the table of docs/model.md: every knob with its symbol, unit, values and meaning."""
    rows = [f"| `{knob.name}` | {knob.symbol or '–'} | {knob.unit or '–'} | {allowed(knob)} | {knob.meaning} |"
            for knob in QUANTITIES.values()]
    return "\n".join(["| knob | symbol | unit | values | meaning |", "|---|---|---|---|---|", *rows])


def allowed(knob: Quantity) -> str:
    """Return the values that a knob can have, in words."""
    words = ", ".join(f"`{word}`" for word in knob.choices)
    if not knob.numeric:
        return words
    numbers = f"{printed(knob.low)} to {printed(knob.high)}"
    return f"{words}, or {numbers}" if words else numbers + (", whole" if knob.whole else "")


def list_of_methods() -> str:
    """Return the list of docs/method.md: every method, what it is, and its limits."""
    items = (f"- **`{one.name}`**: {one.title}. *Limits:* {one.restrictions}." for one in METHODS.values())
    return "\n".join("\n".join(textwrap.wrap(item, 120, subsequent_indent="  ")) for item in items)


def table_of_orders() -> str:
    """Return the table of docs/method.md: the orders of every method, in theory and observed."""
    rows = []
    for one in METHODS.values():
        orders = (one.order, one.observed_smooth, one.order_at_events, one.observed_order, one.observed_with_cut)
        rows.append(f"| `{one.name}` | {' | '.join('–' if math.isnan(order) else f'{order:g}' for order in orders)} |")
    return "\n".join(["| method | smooth: theory | smooth: observed | events: theory | events: observed "
                      "| tension cut: observed |", "|---|---|---|---|---|---|", *rows])


def table_of_drives() -> str:
    """Return the table of docs/scenes.md: every drive by a formula, and a measured one."""
    rows = [f"| `{name}={one.form}` | {one.meaning} |" for name, one in FORMULAS.items()]
    return "\n".join(["| drive | motion of the driver |", "|---|---|", *rows,
                      "| a file | the measured velocity of the shaker over time, or its displacement if there is no velocity; "
                      "[data.md](data.md) describes the files that can be read |"])


def equations() -> str:
    """Return the equations of README.md: the first block of docs/model.md below its heading “Equations”."""
    _, _, below = (ROOT / "docs" / "model.md").read_text(encoding="utf-8").partition("\n## Equations\n")
    block = re.search(r"\n\n((?:    .+\n)+)", below)
    assert block is not None
    return block[1].rstrip("\n")


def table_of_scenes() -> str:
    """Return the table of README.md: every scene with its title, in teaching order."""
    rows = [f"| `{name}` | {scene(name).title} |" for name in scene_names()]
    return "\n".join(["| scene | what it is |", "|---|---|", *rows])


def table_of_libraries() -> str:
    """Return the table of docs/libraries.md: the undocumented parts of libraries in use, and where they are used."""
    rows = []
    for module, table in library_internals.tables().items():
        for without in dict.fromkeys(row.without for row in table):
            used = "<br>".join(f"`{row.owner}`: {', '.join(f'`{name}`' for name in row.names)}" for row in table if row.without == without)
            rows.append(f"| {used} | `{module.replace('.', '/')}.py` | {without} |")
    return "\n".join(["| what | where | without it |", "|---|---|---|", *rows])


def table_of_connection_times() -> str:
    """Return the table of docs/dashboard-server.md: the times in the script that watches the connection."""
    return "\n".join(["| constant | ms | what it is |", "|---|---|---|", *(f"| `{name}` | {value} | {words} |" for name, (value, words) in connection_times().items())])


def table_of_worker_pools() -> str:
    """Return the table of docs/dashboard-server.md: every thread pool, its limits and its purpose."""
    rows = [f"| `{pool.name.upper()}` | {pool.workers} | {f'+{ADDED_NICENESS}' if pool.low_priority else '0'} | "
            f"{pool.per_owner_limit or '–'} | {pool.purpose} |" for pool in POOLS]
    return "\n".join(["| pool | threads | nice value | work of one session at once | what runs there |", "|---|---|---|---|---|", *rows])


def table_of_picture_stages() -> str:
    """Return the table of docs/deployment.md: the stages of a picture, and what helps if one takes long."""
    return "\n".join(["| stage | what happens | if it takes long |", "|---|---|---|",
                      *(f"| `{name}` | {stage.what} | {stage.remedy} |" for name, stage in STAGES.items())])


def table_of_metrics() -> str:
    """Return the table of docs/deployment.md: every metric of the server, its kind and its help text."""
    add_shared_metrics()
    rows = []
    for metric in METRICS.table():
        label, former = f", label `{metric.label}`" if metric.label else "", former_metric(metric.full_name)
        rows.append(f"| `{metric.full_name}`{label} | {metric.kind} | {metric.help}{_also(former) if former else ''} |")
    rows += [f"| `{name}`{', label `stage`' if name == STAGE_TIMES else ''} | histogram | {text} |" for name, text in HISTOGRAMS.items()]
    return "\n".join(["| metric | kind | what it is |", "|---|---|---|", *rows])


def _also(former: FormerMetric) -> str:
    """Return the former name of a metric, in words."""
    changed = "".join(f", where `{now}` is `{then}`" for now, then in former.values.items())
    label = f", with the label `{former.label}`{changed}" if former.label else ""
    return f" Also under its former name `{former.former}`{label}."


def test_command() -> str:
    """Return the command of README.md that runs all tests: the two lines of .ci/test-command as one."""
    return f"```sh\n{' && '.join((ROOT / '.ci' / 'test-command').read_text(encoding='utf-8').splitlines())}\n```"


def table_of_former_names() -> str:
    """Return the table of docs/python.md: every former name that still works, with the present one."""
    kinds = (("", core.NAMES), ("", core.ATTRIBUTES), ("", core.PARAMETERS), ("", core.EXTRAS), ("", core.VARIABLES),
             ("column ", core.COLUMNS), ("command ", own.COMMANDS), ("tab ", own.TABS), ("option ", own.OPTIONS), ("JSON key ", (*own.KEYS, *core.KEYS)))
    rows = [f"| {kind}`{row.name}` | `{row.former}` | {row.removed_in} |" for kind, table in kinds for row in table]
    return "\n".join(["| name | former name | removed in |", "|---|---|---|", *rows])
