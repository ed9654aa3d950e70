"""Share links: everything that differs comes back, and every bad field is refused by itself."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from app.page.share import EXTRAS, decode, encode
from granchain_core import scene, scene_names


@given(name=st.sampled_from(scene_names()), f=st.floats(0.1, 1e6), amplitude=st.floats(1e-12, 1e-4),
       damping=st.floats(0.0, 1e6), stiffness=st.floats(0.0, 1e10), beads=st.integers(1, 10_000),
       law=st.sampled_from(["linear", "tsuji", "kuwabara-kono", "none"]), mode=st.sampled_from(EXTRAS["mode"]))
def test_a_link_brings_back_exactly_what_was_shared(name: str, f: float, amplitude: float, damping: float,
                                                    stiffness: float, beads: int, law: str, mode: str) -> None:
    shown = scene(name).evolve(f=f, A0=amplitude, D=damping, k=stiffness, N=beads, dissipation=law)
    back, extras, refused = decode(encode(shown, {"mode": mode}))
    assert back == shown and refused == []
    assert extras.get("mode", EXTRAS["mode"][0]) == mode


def test_a_link_that_was_sent_once_means_today_what_it_meant() -> None:
    """Literal on purpose: if a preset, a default or a name changes, links that are out there change with it."""
    shown, extras, refused = decode(
        "v=1&scene=rig&f=72.5&A0=6e-06&D=12.5&k=1500.0&N=9&F0=0.25&wall=rigid&dissipation=tsuji&tension=cut"
        "&accuracy=1e-08&mode=live&start=previous&look=dark")
    assert refused == []
    assert extras == {"mode": "live", "start": "previous", "look": "dark"}
    assert shown.name == "rig"
    assert {name: value for name, value in shown.knobs.items() if name != "kappa"} == {
        "f": 72.5, "A0": 6e-6, "D": 12.5, "k": 1500.0, "N": 9, "F0": 0.25, "wall": "rigid", "dissipation": "tsuji",
        "tension": "cut", "accuracy": 1e-8}
    bead = shown.bead(1)  # what the link leaves to the preset
    assert (bead.mass, bead.radius, bead.young, bead.poisson) == (0.067355, 0.0127, 210e9, 0.3)


def test_every_bad_field_gets_its_sentence_and_the_good_ones_count() -> None:
    back, extras, refused = decode("v=1&scene=rig&f=nan&A0=1e3&foo=1&mode=x&D=12&look=dark")
    assert back == scene("rig").evolve(D=12.0)
    assert extras == {"look": "dark"}
    assert len(refused) == 4 and all(sentence.endswith(".") for sentence in refused)


def test_an_unknown_scene_or_version_is_said_and_the_first_scene_shown() -> None:
    back, _, refused = decode("v=9&scene=rigg")
    assert back == scene(scene_names()[0]) and len(refused) == 2


@given(st.text(max_size=200))
def test_no_query_string_breaks_the_page(query: str) -> None:
    back, extras, refused = decode(query)
    assert back.N >= 1 and isinstance(extras, dict) and all(isinstance(s, str) for s in refused)


def test_a_link_of_unreasonable_length_is_not_read() -> None:
    assert "longer than" in decode("f=" + "1" * 5000)[2][0]
