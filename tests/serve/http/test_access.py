"""Access to the server as configured on the command line: addresses, origins, secrets and ways of signing in."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any

import pytest
from listening import Listening

from app import server
from app.cli import main
from app.server import Access, is_loopback

_SECRET = b"a secret of this test alone, long enough"


def _has_ipv6() -> bool:
    try:
        with socket.socket(socket.AF_INET6) as probe:
            probe.bind(("::1", 0))
    except OSError:
        return False
    return True


@pytest.mark.parametrize(("address", "only_here"), [
    ("127.0.0.1", True), ("localhost", True), ("::1", True), ("127.8.8.8", True), ("0.0.0.0", False), ("", False),
    ("::", False), ("192.168.1.4", False), ("granchain.example.org", False)])
def test_which_addresses_are_public(address: str, only_here: bool) -> None:
    assert is_loopback(address) is only_here


@pytest.mark.parametrize("public", [["--address", "0.0.0.0"], ["--behind-proxy"]])
@pytest.mark.parametrize("words", [
    [], ["--allow-websocket-origin", "granchain.example.org"], ["--generate-secret"]])
def test_a_public_server_needs_origins_and_a_secret(public: list[str], words: list[str], capsys: pytest.CaptureFixture[str],
                                                    monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("BOKEH_SECRET_KEY", raising=False)
    assert main(["serve", *public, "--port", "6199", *words]) == 2
    said = capsys.readouterr().err
    assert "--allow-websocket-origin" in said and "--generate-secret" in said and "docs/security.md" in said


@pytest.mark.skipif(not _has_ipv6(), reason="this machine has no ::1")
def test_an_address_of_ipv6_is_served_under_its_own_name() -> None:
    one = Listening(Access(origins=("[2001:db8::7]:443", "[2001:DB8:0::9]:443")), "::1")
    try:
        assert one.ask("/")[0] == 200
        hosts = {"[::1]:5006": 200, "[2001:db8::7]": 200, "[::2]:5006": 421}
        assert {host: one.ask("/liveness", Host=host)[0] for host in hosts} == hosts
        origins = {"https://[2001:db8::7]:443": 101, "https://[2001:db8::9]:443": 101, "https://[2001:db8::8]:443": 403}
        assert {origin: one.connect(one.token(), Origin=origin) for origin in origins} == origins
    finally:
        one.stop()


def test_options_reach_the_server(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(server, "serve", lambda *words, **named: asked.append((words, named)))
    (tmp_path / "secret").write_bytes(_SECRET + b"\n")
    (tmp_path / "users.json").write_text(json.dumps({"ada": "lovelace"}))
    assert main(["serve", "--address", "0.0.0.0", "--allow-websocket-origin", "a.example.org", "--secret-file",
                 str(tmp_path / "secret"), "--basic-auth", str(tmp_path / "users.json"), "--most-visitors", "9"]) == 0
    (words, named), = asked
    access = named["access"]
    assert words == (5006, "0.0.0.0") and access.secret == _SECRET and access.max_sessions == 9
    assert access.origins == ("a.example.org",) and dict(access.sign_in)["basic_auth"] == str(tmp_path / "users.json")
    assert len(dict(access.sign_in)["cookie_secret"]) == 64


@pytest.mark.parametrize(("rights", "warned"), [(0o600, False), (0o640, False), (0o644, True)])
def test_a_secret_that_all_users_can_read_is_a_line_in_the_log(
        rights: int, warned: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(server, "serve", lambda *args, **kwargs: kwargs["on_ready_to_listen"]())
    secret = tmp_path / "secret"
    secret.write_bytes(_SECRET)
    secret.chmod(rights)
    with caplog.at_level("WARNING", "granchain"):
        assert main(["serve", "--secret-file", str(secret)]) == 0
    assert ["can read the secret" in one for one in caplog.messages] == [True] * warned


@pytest.mark.parametrize(("origin", "warned"), [
    ("*", True), ("*:5006", True), ("*.*", True), ("*.example.org", False), ("a.example.org", False), ("[2001:db8::7]:443", False)])
def test_a_pattern_for_all_names_is_a_line_in_the_log(origin: str, warned: bool, monkeypatch: pytest.MonkeyPatch,
                                                      caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(server, "serve", lambda *args, **kwargs: kwargs["on_ready_to_listen"]())
    with caplog.at_level("WARNING", "granchain"):
        assert main(["serve", "--allow-websocket-origin", origin]) == 0
    assert ["switches off the checks" in one for one in caplog.messages] == [True] * warned


def test_an_origin_is_compared_in_lower_case() -> None:
    one = Listening(Access(origins=("A.Example.org",)))
    try:
        assert one.ask("/liveness", Host="a.example.org")[0] == 200
        assert one.connect(one.token(), Origin="https://a.example.org") == 101
    finally:
        one.stop()


def test_the_secret_of_cookies_is_given_or_follows_from_that_of_the_sessions(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Otherwise, each process signs with its own secret, and visitors who reach another one have to sign in again."""
    asked: list[str] = []
    monkeypatch.setattr(server, "serve", lambda *_, access, **named: asked.append(dict(access.sign_in)["cookie_secret"]))
    (tmp_path / "users.json").write_text(json.dumps({"ada": "lovelace"}))
    for name in "ab":
        (tmp_path / name).write_bytes(_SECRET + name.encode())

    def start(*words: str) -> str:
        assert main(["serve", "--basic-auth", str(tmp_path / "users.json"), *words]) == 0
        return asked[-1]

    monkeypatch.delenv("PANEL_COOKIE_SECRET", raising=False)
    monkeypatch.delenv("BOKEH_SECRET_KEY", raising=False)
    first, again, other = (start("--secret-file", str(tmp_path / name)) for name in "aab")
    assert first == again != other and (_SECRET + b"a").decode() not in first
    assert start() != start(), "without a secret, each process has its own"
    monkeypatch.setenv("PANEL_COOKIE_SECRET", "given")
    assert start("--secret-file", str(tmp_path / "a")) == "given"


@pytest.mark.parametrize(("words", "sentence"), [
    (["--secret-file", "/nowhere/secret"], "cannot be read"), (["--oauth-provider", "github"], "PANEL_OAUTH_KEY"),
    (["--max-sessions", "0"], "outside 1 to 10000"), (["--basic-auth", "/nowhere"], "cannot be read")])
def test_unusable_options_are_refused_with_a_sentence(words: list[str], sentence: str,
                                                        capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", *words]) == 2
    assert sentence in capsys.readouterr().err
