"""The stand-in hosts that tests give to pages have the dashboard's interface."""

from __future__ import annotations

import inspect

from host import FakeHost

from app.session.host import PageHost, WorkHost


def test_the_fake_host_has_the_signatures_of_the_host() -> None:
    shared = [name for name in vars(FakeHost) if name in dir(PageHost) and not name.startswith("_")]
    assert {name for name in dir(WorkHost) if not name.startswith("_")} <= set(shared)
    for name in shared:
        fake, real = getattr(FakeHost, name), getattr(PageHost, name)
        if callable(fake):
            assert list(inspect.signature(fake).parameters) == list(inspect.signature(real).parameters), name
        else:
            assert isinstance(real, property), name


def test_methods_that_drive_the_fake_host_are_no_methods_of_a_host() -> None:
    """A page that called these methods would only work in tests."""
    assert {name for name in dir(FakeHost) if not name.startswith("_")} - set(dir(PageHost)) == {
        "leave", "call_waiting", "run_callbacks_until"}
