"""The stand-in hosts that tests give to pages have the dashboard's interface."""

from __future__ import annotations

import inspect

from host import FakeHost

from app.session.host import PageHost, WorkHost


def test_what_the_fake_host_has_is_called_as_a_host_is() -> None:
    shared = [name for name in vars(FakeHost) if name in dir(PageHost) and not name.startswith("_")]
    assert {name for name in dir(WorkHost) if not name.startswith("_")} <= set(shared)
    for name in shared:
        fake, real = getattr(FakeHost, name), getattr(PageHost, name)
        if callable(fake):
            assert list(inspect.signature(fake).parameters) == list(inspect.signature(real).parameters), name
        else:
            assert isinstance(real, property), name


def test_what_drives_the_fake_host_is_no_part_of_a_host() -> None:
    """A page that called these methods would only work in tests."""
    assert {name for name in dir(FakeHost) if not name.startswith("_")} - set(dir(PageHost)) == {
        "leave", "call_waiting", "run_callbacks_until"}
