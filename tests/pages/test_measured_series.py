"""Measured time series in the data tab: they are drawn over the picture, and their differences from it are stated."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
from data_tab import after, data_page, sent, show
from headless_dashboard import Dashboard

from granchain_core import Scene, scene
from granchain_core.virtual_experiment import Sensors, virtual_series_csv


def with_series(dashboard: Dashboard, chain: Scene) -> str:
    """Return the tab's sentence about a series of `chain` over the settled picture at 340 Hz."""
    text = virtual_series_csv(chain, 12, Sensors(rate=256.0 * chain.f, noise=0.005)).encode()
    show(dashboard)
    dashboard.receive(sent(text))
    dashboard.run_callbacks_until(lambda: re.search("series|rms", str(dashboard.views.tabs.state.get("misfit"))) is not None)
    return str(dashboard.views.tabs.state["misfit"]["sentence"])


def test_a_series_goes_over_the_force_trains_and_moves_with_the_picture(dashboard: Dashboard) -> None:
    """For the same scene, the differences are the noise; the lines are drawn over both trains and removed again."""
    sentence = with_series(dashboard, scene("sec2"))
    left = [float(number) for number in re.findall(r"([0-9.e-]+) N for the", sentence)]
    assert len(left) == 2 and all(0.003 < misfit < 0.02 for misfit in left)  # the noise is 5 mN; the jumps are smoothed alike
    trains = dashboard.views.trains
    lines = [[drawn for drawn in plot.renderers if drawn.level == "overlay"] for plot in (trains.left, trains.right)]
    assert [len(overlays) for overlays in lines] == [1, 1]
    assert all(len(overlays[0].data_source.data["time"]) > 1000 for overlays in lines)
    settled = dashboard.session.settled
    assert settled is not None
    preview = replace(settled, final=False)  # for knobs that have moved
    data_page(dashboard).picture_ready(preview)
    assert dashboard.views.tabs.state["misfit"] is None
    data_page(dashboard).picture_ready(settled)
    dashboard.run_callbacks_until(lambda: "rms" in str(dashboard.views.tabs.state["misfit"]))
    dashboard.receive({"do": "measurement-remove"})
    assert all(len(overlays[0].data_source.data["time"]) == 0 for overlays in lines)


def test_the_model_passes_the_low_pass_of_the_sensors(dashboard: Dashboard) -> None:
    """A record of the same scene by 2 kHz sensors differs only by noise once their bandwidth is taken into account."""
    chain = scene("sec2")

    def differences(message: dict[str, Any]) -> list[float]:
        dashboard.views.tabs.update_state(misfit=None)
        dashboard.receive(message)
        dashboard.run_callbacks_until(lambda: "rms" in str(dashboard.views.tabs.state.get("misfit")))
        return [float(number) for number in re.findall(r"([0-9.e-]+) N for the", dashboard.views.tabs.state["misfit"]["sentence"])]

    show(dashboard)
    record = virtual_series_csv(chain, 12, Sensors(rate=256.0 * chain.f, noise=0.003, bandwidth=2000.0)).encode()
    without = differences(sent(record))
    given = differences({"do": "measurement-bandwidth", "value": "2000"})
    assert min(without) > 0.015 and all(0.002 < misfit < 0.004 for misfit in given)
    assert "a low-pass of 2000 Hz" in dashboard.views.tabs.state["misfit"]["sentence"]
    assert differences({"do": "measurement-bandwidth", "value": ""}) == without
    for wrong in ("2 kHz", "0.5", None):
        dashboard.receive({"do": "measurement-bandwidth", "value": wrong})
        assert "bandwidth" in dashboard.session.sentence


def test_a_measured_displacement_goes_over_the_drive(dashboard: Dashboard) -> None:
    """Its zero is arbitrary; aligned by the forces, it agrees with the drive of the picture."""
    chain = scene("sec2")
    rows = virtual_series_csv(chain, 12, Sensors(rate=256.0 * chain.f)).splitlines()
    table = np.array([[float(number) for number in row.split(",")] for row in rows[3:]])
    # integral of the velocity in the second column: v = A0 ω cos(ωt + φ), u = A0 sin(ωt + φ) + offset
    omega = 2.0 * np.pi * chain.f
    phase = np.angle(np.mean((table[:, 1]) * np.exp(-1j * omega * table[:, 0])))
    swing = 3e-6 + chain.A0 * np.sin(omega * table[:, 0] + phase)
    text = "time (s),displacement (m),output force (N)\n" + "".join(
        f"{t:.9g},{u:.9g},{force:.9g}\n" for t, u, force in zip(table[:, 0], swing, table[:, 3], strict=True))
    show(dashboard)
    dashboard.receive(sent(text.encode()))
    dashboard.run_callbacks_until(lambda: "rms" in str(dashboard.views.tabs.state.get("misfit")))
    trains = dashboard.views.trains
    line, = (drawn for drawn in trains.left.renderers if drawn.level == "overlay")
    drawn = {name: np.asarray(values, dtype=float) for name, values in line.data_source.data.items()}
    factor = chain.A0 / 500.0  # the axis is in nm
    model = np.interp(drawn["time"], np.asarray(trains._source.data["time"]), np.asarray(trains._source.data["drive"]))
    assert line.x_range_name == "drive" and len(drawn["time"]) > 500
    # the model's samples are interpolated linearly
    np.testing.assert_allclose(drawn["force"], model, atol=0.02 * chain.A0 / factor)


def test_a_series_without_a_force_is_refused(dashboard: Dashboard) -> None:
    rows = "".join(f"{1e-3 * i},{0.1 * i}\n" for i in range(12)).encode()
    assert "without a force" in after(dashboard, sent(b"time_s,velocity_m_s\n" + rows), "misfit")
