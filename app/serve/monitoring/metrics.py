"""The server's metrics, which `/metrics` shows (app/serve/http/health.py)."""

from __future__ import annotations

import asyncio
import math
import threading
import time
from bisect import bisect_left
from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from typing import Literal, NamedTuple

from granchain_core.version import __version__

from ...former_names import former_metric
from .process import cpu_seconds, most_descriptors, open_descriptors, os_threads, resident_memory, start_time

#: Upper bounds of both histograms [s].
BUCKETS = (0.025, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0)


class Stage(NamedTuple):
    """A stage of a picture: what happens in it, and what an operator can do if it takes long."""

    what: str
    remedy: str


#: The stages of a picture, by their label in `/metrics`.
STAGES = {
    "turn": Stage("it waits for the session's previous computation, for a thread and for a time slice (turn)",
                  "more cores, or another machine"),
    "kernels": Stage("it waits for kernels that are being compiled", "compile them beforehand with `granchain warm`"),
    "compute": Stage("it is computed, or the session waits for the same picture of another session",
                     "nothing: the visitor's chain is long"),
    "prepare": Stage("the arrays to be drawn are prepared", "more cores: other threads are using them"),
    "loop": Stage("it waits for the event loop", "another process: a process uses one core for its event loop"),
    "pace": Stage("it waits until the browser has painted earlier pictures", "nothing: see `travel` and `paint`"),
    "travel": Stage("it is sent and its acknowledgement comes back; both wait for an event loop",
                    "look at the network and at `granchain_event_loop_lag_seconds`"),
    "paint": Stage("the browser draws it", "nothing: the visitor's computer is slow"),
}
#: The histograms: name and help text.
ANSWERS, STAGE_TIMES = "granchain_answer_seconds", "granchain_picture_stage_seconds"
HISTOGRAMS = {
    ANSWERS: "Latency from the action of a change of scene, knob, start or mode on the event loop until its first "
             "picture is offered to the browser: without network and painting.",
    STAGE_TIMES: "Time of each stage of these pictures, counted when the picture is on the screen.",
}
#: Interval between measurements of the event loop's lag [s].
_LAG_INTERVAL = 0.25
#: Number of measurements that are kept: ten seconds' worth.
_LAGS_KEPT = 40
#: A single lag above this also makes the server busy [s], since the mean over ten seconds hides a single stall.
_BUSY_STALL = 1.0
#: Mean lag of the event loop, or mean wait for a turn, above which the server counts as busy [s].
_BUSY_WAIT = 0.3

#: The counters of `Metrics.count`: name without `_total`, and help text.
COUNTERS = {
    "pictures": "Pictures sent, steps of live runs included. Pictures that were replaced before they were sent are not "
                "counted.",
    "cancelled": "Computations of pictures that were cancelled.",
    "refused_sessions": "Sessions refused because `--max-sessions` were already open.",
    "refused_pictures": "Pictures refused because they would take too long.",
    "refused_messages": "Messages that no web page sends, too many frames, and too many unsent bytes; each closed its "
                        "connection.",
    "errors": "Unexpected failures; each is in the log.",
}


class Metric(NamedTuple):
    """A Prometheus metric; the name of a counter ends with `_total`.

    `read` is called at each request for `/metrics`. With a `label`, it returns a number for each value of the label.
    The prefix is `process` for metrics that Prometheus clients report for any program.
    """

    name: str
    kind: Literal["counter", "gauge"]
    help: str
    read: Callable[[], float | Mapping[str, float]]
    label: str = ""
    prefix: str = "granchain"

    @property
    def full_name(self) -> str:
        """The name in `/metrics`."""
        return f"{self.prefix}_{self.name}"


class Histogram:
    """Durations counted by `BUCKETS`; the caller holds a lock."""

    def __init__(self) -> None:
        self.counts = [0] * (len(BUCKETS) + 1)
        self.total = 0.0

    def add(self, seconds: float) -> None:
        """Count a duration."""
        self.counts[bisect_left(BUCKETS, seconds)] += 1
        self.total += seconds

    def lines(self, name: str, label: str = "") -> list[str]:
        """Return the lines in Prometheus's text format; `label` is a label with its value."""
        lines, count = [], 0
        for bound, counted in zip((*BUCKETS, math.inf), self.counts, strict=True):
            count += counted
            upper = "+Inf" if bound == math.inf else f"{bound:g}"
            lines.append(f'{name}_bucket{{{label}{"," * bool(label)}le="{upper}"}} {count}')
        labels = f"{{{label}}}" if label else ""
        return [*lines, f"{name}_sum{labels} {_written(self.total)}", f"{name}_count{labels} {count}"]


class Metrics:
    """Counts since the server start; an answer is the time from a change to its first picture. Any thread may count."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.sessions = 0
        self.opened = 0
        self.counted = dict.fromkeys(COUNTERS, 0)
        self.answers = Histogram()
        self.stages = {stage: Histogram() for stage in STAGES}
        self._lags: deque[float] = deque(maxlen=_LAGS_KEPT)
        #: Metrics of other modules; the server sets them.
        self.added: tuple[Metric, ...] = ()
        #: Returns the mean wait of computations before they begin [s]; the server sets it.
        self.turn_wait: Callable[[], float] = lambda: 0.0

    def count(self, name: str) -> None:
        """Add one to a counter of `COUNTERS`."""
        with self._lock:
            self.counted[name] += 1

    def session_opened(self) -> None:
        """Count a page that was opened."""
        with self._lock:
            self.sessions += 1
            self.opened += 1

    def session_closed(self) -> None:
        """Count a page that was closed."""
        with self._lock:
            self.sessions -= 1

    def answered(self, seconds: float) -> None:
        """Count a first picture that was ready `seconds` after its request."""
        with self._lock:
            self.answers.add(seconds)

    def picture_painted(self, seconds: Mapping[str, float]) -> None:
        """Count the stages of a picture that is on the screen, by their names in `STAGES`."""
        with self._lock:
            for stage, duration in seconds.items():
                self.stages[stage].add(duration)

    def lagged(self, seconds: float) -> None:
        """Record that an iteration of the event loop was `seconds` late."""
        self._lags.append(seconds)

    @property
    def event_loop_lag(self) -> float:
        """The mean lag of the event loop in the last ten seconds [s]."""
        return sum(self._lags) / len(self._lags) if self._lags else 0.0

    @property
    def largest_lag(self) -> float:
        """The largest lag of the event loop in the last ten seconds [s]."""
        return max(self._lags, default=0.0)

    @property
    def busy(self) -> bool:
        """Whether visitors notice the load, by the lag of the event loop or by the wait for a turn to compute."""
        return max(self.event_loop_lag, self.turn_wait()) > _BUSY_WAIT or self.largest_lag > _BUSY_STALL

    async def watch(self) -> None:
        """Measure the lag of the event loop at regular intervals."""
        while True:
            due = time.monotonic() + _LAG_INTERVAL
            await asyncio.sleep(_LAG_INTERVAL)
            self.lagged(max(0.0, time.monotonic() - due))

    def table(self) -> list[Metric]:
        """Return all metrics except the histograms."""
        return [
            Metric("build_info", "gauge", "Always 1; the label is the running release of granchain.",
                   lambda: {__version__: 1}, "version"),
            Metric("sessions", "gauge", "Sessions: web pages that are open.", lambda: self.sessions),
            Metric("sessions_opened_total", "counter", "Sessions opened.", lambda: self.opened),
            *(Metric(f"{name}_total", "counter", text, partial(self.counted.__getitem__, name))
              for name, text in COUNTERS.items()),
            Metric("event_loop_lag_seconds", "gauge",
                   f"Mean lag of the event loop in the last ten seconds; above {_BUSY_WAIT:g} the web page says that "
                   "the server is busy.", lambda: self.event_loop_lag),
            Metric("event_loop_lag_max_seconds", "gauge",
                   f"Largest lag of the event loop in the last ten seconds; above {_BUSY_STALL:g} the web page says "
                   "that the server is busy.", lambda: self.largest_lag),
            Metric("turn_wait_seconds", "gauge",
                   "Mean wait of computations before they could begin, in the last ten seconds; above "
                   f"{_BUSY_WAIT:g} the web page says that the server is busy.", self.turn_wait),
            Metric("resident_memory_bytes", "gauge", "Resident memory.", resident_memory, prefix="process"),
            Metric("threads", "gauge", "Threads of the operating system.", os_threads, prefix="process"),
            Metric("threads", "gauge", "Threads known to Python, which exclude those of numerical libraries.",
                   threading.active_count),
            Metric("cpu_seconds_total", "counter", "Processor time of all threads, user and system.", cpu_seconds,
                   prefix="process"),
            Metric("start_time_seconds", "gauge", "Start of the process, in seconds since 1970.", start_time,
                   prefix="process"),
            Metric("open_fds", "gauge", "Open file descriptors, sockets included.", open_descriptors,
                   prefix="process"),
            Metric("max_fds", "gauge", "Largest number of open file descriptors that the system allows.",
                   most_descriptors, prefix="process"),
            *self.added,
        ]

    def text(self) -> str:
        """Return all metrics in Prometheus's text format, version 0.0.4."""
        lines: list[str] = []
        for metric in self.table():
            value = metric.read()
            lines += _lines(metric.full_name, metric, metric.label, value)
            if former := former_metric(metric.full_name):
                if isinstance(value, Mapping):
                    value = {former.values.get(key, key): number for key, number in value.items()}
                lines += _lines(former.former, metric, former.label or metric.label, value)
        for name, text in HISTOGRAMS.items():
            lines += [f"# HELP {name} {text}", f"# TYPE {name} histogram"]
            if name == ANSWERS:
                lines += self.answers.lines(name)
            else:
                for stage, histogram in self.stages.items():
                    lines += histogram.lines(name, f'stage="{stage}"')
        return "\n".join(lines) + "\n"


def _lines(name: str, metric: Metric, label: str, value: float | Mapping[str, float]) -> list[str]:
    """Return the lines of a metric under a name, with its help text."""
    head = [f"# HELP {name} {metric.help}", f"# TYPE {name} {metric.kind}"]
    if isinstance(value, Mapping):
        return head + [f'{name}{{{label}="{key}"}} {_written(number)}' for key, number in value.items()]
    return [*head, f"{name} {_written(value)}"]


def _written(value: float) -> str:
    """Write a number with all its digits: a counter rounded to six digits would stand still and then jump."""
    if not math.isfinite(value):
        return "NaN" if math.isnan(value) else "+Inf" if value > 0.0 else "-Inf"
    return str(int(value)) if value == int(value) else repr(float(value))


METRICS = Metrics()
