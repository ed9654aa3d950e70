"""docs/deployment.md, docs/nginx.conf and the Dockerfile name the same processes, limits and ports."""

from __future__ import annotations

import re

import pytest
from documents import ROOT

from app.serve.computing.worker_pools import LONG
from app.serve.monitoring import metrics
from app.serve.monitoring.metrics import HISTOGRAMS, METRICS
from app.serve.monitoring.picture_stages import SLOW_PICTURE
from app.server import add_shared_metrics

pytestmark = pytest.mark.quick

TEXT = (ROOT / "docs" / "deployment.md").read_text(encoding="utf-8")
NGINX = (ROOT / "docs" / "nginx.conf").read_text(encoding="utf-8")
DOCKER = (ROOT / "Dockerfile").read_text(encoding="utf-8")


def test_every_example_has_the_same_processes() -> None:
    """If they differed, nginx would first send visitors to a process that does not exist."""
    ports = re.findall(r"^    server 127\.0\.0\.1:(\d+);", NGINX, re.MULTILINE)
    (loop,) = re.findall(r"for port in ([\d ]+); do", TEXT)
    (first, last), = re.findall(r"granchain@\{(\d+)\.\.(\d+)\}", TEXT)
    (targets,) = re.findall(r"targets: \[(.+)\]", TEXT)
    assert ports == loop.split() == [str(one) for one in range(int(first), int(last) + 1)] == re.findall(r":(\d+)\"", targets)


def test_the_page_below_a_path_has_the_limits_of_the_other() -> None:
    limits = set(re.findall(r"limit_req zone.+;|error_page.+?;", NGINX))
    (locations,) = re.findall(r"```nginx\n(.+?)```", TEXT, re.DOTALL)
    limits -= {"limit_req zone=granchain_login burst=10 nodelay;"}  # nobody signs in under a path
    assert len(limits) == 2 and limits == set(re.findall(r"limit_req zone.+;|error_page.+?;", locations))


def test_the_health_check_of_the_container_asks_at_its_port() -> None:
    entry = DOCKER.partition("\nENTRYPOINT")[2]
    (port,) = re.findall(r'"--port", "(\d+)"', entry)
    assert re.findall(r"127\.0\.0\.1:(\d+)/liveness", DOCKER) == re.findall(r"^EXPOSE (\d+)", DOCKER, re.MULTILINE) == [port]
    assert f"port is always {port}" in " ".join(TEXT.split())


def test_the_advice_of_monitoring_has_the_thresholds_of_the_code() -> None:
    for name, value in (("event_loop_lag_seconds", metrics._BUSY_WAIT), ("event_loop_lag_max_seconds", metrics._BUSY_STALL),
                        ("turn_wait_seconds", metrics._BUSY_WAIT), ('pool_queued{pool="long"}', LONG.workers)):
        assert f"| `granchain_{name}` above {value:g} " in TEXT
    words = " ".join(TEXT.split())
    assert f"the largest lag with {metrics._BUSY_STALL:g} s, the other two with {metrics._BUSY_WAIT:g} s." in words
    assert f"for each picture that took more than {SLOW_PICTURE:g} s" in words
    assert {8: "one of eight threads"}[LONG.workers] in words


def test_the_advice_of_monitoring_names_metrics_that_there_are() -> None:
    add_shared_metrics()
    table = TEXT.partition("| sign |")[2].partition("\n\n")[0]
    named = set(re.findall(r"`((?:granchain|process)_\w+)", table))
    assert len(named) > 8 and named <= {*HISTOGRAMS, *(f"{name}_bucket" for name in HISTOGRAMS), *(metric.full_name for metric in METRICS.table())}
