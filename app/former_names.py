"""Former names of the command line and the server that still work, one row each. Delete a row to retire its name.

docs/python.md lists the former commands, options, tabs and JSON keys, docs/deployment.md the former metrics.
granchain_core/former_names.py has the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from granchain_core.former_names import FormerName

#: Commands; lists of commands leave out the former ones.
COMMANDS = (FormerName("strobes", "bifurcation-diagram", "stays"),)
#: Options.
OPTIONS = (FormerName("--most-visitors", "--max-sessions", "stays"),)
#: Tabs of the dashboard; links shared earlier still have the former names.
TABS = (FormerName("hard", "hard-cases", "stays"),)
#: JSON keys, each after the command that prints it.
KEYS = (
    FormerName("pulse.speed_beads", "pulse.speed_beads_s", "stays"),
    FormerName("pulse.speed", "pulse.speed_m_s", "stays"),
)


class FormerMetric(NamedTuple):
    """A former name of a metric, with its label and the former values of the label that have changed, if any."""

    former: str
    name: str
    label: str = ""
    values: Mapping[str, str] = MappingProxyType({})


#: Metrics.
METRICS = (
    FormerMetric("granchain_visitors", "granchain_sessions"),
    FormerMetric("granchain_visits_total", "granchain_sessions_opened_total"),
    FormerMetric("granchain_refused_visitors_total", "granchain_refused_sessions_total"),
    FormerMetric("granchain_resident_memory_bytes", "process_resident_memory_bytes"),
    FormerMetric("granchain_queue_waiting", "granchain_pool_queued", "queue", {"session_work": "visitors"}),
    FormerMetric("granchain_queue_busy", "granchain_pool_busy_threads", "queue", {"session_work": "visitors"}),
)

_COMMANDS = {row.former: row.name for row in COMMANDS}
_METRICS = {row.name: row for row in METRICS}
_TABS = {row.former: row.name for row in TABS}


def present_command(word: str) -> str:
    """Return the present name of a command, which may be `word` itself."""
    return _COMMANDS.get(word, word)


def present_tab(name: str) -> str:
    """Return the present name of a tab, which may be `name` itself."""
    return _TABS.get(name, name)


def names_of_option(name: str) -> tuple[str, ...]:
    """Return an option's name and its former names."""
    return (name, *(row.former for row in OPTIONS if row.name == name))


def former_metric(name: str) -> FormerMetric | None:
    """Return the former name of a metric, if it has one."""
    return _METRICS.get(name)
