"""Share links: every difference is restored, and every bad field is refused individually."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.dashboard.addresses import apply_address
from app.dashboard.table import overlay_names
from app.pages.stories.page import story_step
from app.session.initial_state import MOST_BEADS_IN_LINK
from app.session.pins import NAMES, Pin
from app.session.session import Session
from app.session.share import LONGEST_LINK, SPEEDS, VIEW, VIEW_VALUES, decode, encode, joined, pins_in
from granchain_core import BadInput, State, scene, scene_names
from tools.links import FILE, meaning

#: The meaning of a link with only the name of a scene, fixed since the scene was added.
MEANINGS = json.loads(FILE.read_text(encoding="utf-8"))


@given(name=st.sampled_from(scene_names()), f=st.floats(0.1, 1e6), amplitude=st.floats(1e-12, 1e-4),
       damping=st.floats(0.0, 1e6), stiffness=st.floats(0.0, 1e10), beads=st.integers(1, 10_000),
       law=st.sampled_from(["linear", "tsuji", "kuwabara-kono", "none"]), mode=st.sampled_from(VIEW_VALUES["mode"]))
def test_a_link_restores_exactly_the_shared_state(name: str, f: float, amplitude: float, damping: float,
                                                    stiffness: float, beads: int, law: str, mode: str) -> None:
    shown = scene(name).evolve(f=f, A0=amplitude, D=damping, k=stiffness, N=beads, dissipation=law)
    back, fields, refused = decode(encode(shown, {"mode": mode}))
    assert back == shown and refused == []
    assert fields.get("mode", VIEW_VALUES["mode"][0]) == mode


def test_links_of_earlier_versions_keep_their_meaning() -> None:
    """The link is literal on purpose: if a preset, a default or a name changes, so do links already in use."""
    shown, fields, refused = decode(
        "v=1&scene=rig&f=72.5&A0=6e-06&D=12.5&k=1500.0&N=9&F0=0.25&wall=rigid&dissipation=tsuji&tension=cut"
        "&accuracy=1e-08&mode=live&start=previous&look=dark")
    assert refused == []
    assert fields == {"mode": "live", "start": "previous", "look": "dark"}
    assert shown.name == "rig"
    said = {"f": 72.5, "A0": 6e-6, "D": 12.5, "k": 1500.0, "N": 9, "F0": 0.25, "wall": "rigid", "dissipation": "tsuji",
            "tension": "cut", "accuracy": 1e-8}
    silent = {"dimer": 1.0, "taper": 1.0, "striker": 1.0, "site": 1, "impurity": 1.0, "drive": "harmonic", "strike": 0.0, "end": "first"}
    knobs = {name: value for name, value in shown.knobs.items() if name != "kappa"}
    assert knobs.items() >= {**said, **silent}.items()
    assert all(knobs[name] == scene("rig").knobs[name] for name in {*knobs} - {*said, *silent})  # knobs added later


@pytest.mark.parametrize("name", MEANINGS)
def test_a_link_to_a_preset_keeps_its_meaning(name: str) -> None:
    """The file has had a row since the scene was added; κ follows from k and is known up to rounding.

    A knob of `sec2` that was added later has its default in every link.
    """
    shown, fields, refused = decode(f"v=1&scene={name}")
    assert (shown.name, fields, refused) == (name, {}, [])
    found, said = meaning(shown), MEANINGS[name]
    assert found.keys() == said.keys() or (name == "sec2" and found.keys() > said.keys())
    assert all(found[key] == pytest.approx(value, rel=1e-12) if key in ("k", "kappa") else found[key] == value
               for key, value in said.items())


def test_every_preset_has_a_link_with_a_recorded_meaning() -> None:
    assert set(MEANINGS) == set(scene_names())  # otherwise run: python -m tools.update


def test_a_link_with_kappa_keeps_its_k() -> None:
    shown, _, refused = decode("v=1&scene=rig&A0=6e-06&kappa=0.002")
    assert refused == [] and shown.A0 == 6e-6
    assert shown.k == pytest.approx(60059.142449055784, rel=1e-12)


def test_a_bad_field_gets_a_sentence_and_the_others_count() -> None:
    back, fields, refused = decode("v=1&scene=rig&f=nan&A0=1e3&foo=1&mode=x&D=12&look=dark")
    assert back == scene("rig").evolve(D=12.0)
    assert fields == {"look": "dark"}
    assert len(refused) == 4 and all(sentence.endswith(".") for sentence in refused)


def test_an_unknown_scene_or_version_is_reported_and_the_first_scene_shown() -> None:
    back, _, refused = decode("v=9&scene=rigg")
    assert back == scene(scene_names()[0]) and len(refused) == 2


@given(chosen=st.fixed_dictionaries({name: st.sampled_from(values) for name, values in VIEW_VALUES.items()}))
def test_every_view_setting_is_restored_from_a_link(chosen: dict[str, str]) -> None:
    """Settings of the link replace those of the session; `look`, which the browser adds, is read but not written."""
    left, back = Session(), Session(mode="live", scale="fit", speed=5.0, energy_account=True, theme="dark", curves="none")
    left.apply_view(chosen)
    _, refused = apply_address(back, left.link + f"&look={chosen['look']}")
    assert refused == [] and "look=" not in left.link
    assert all(getattr(back, field.attribute) == getattr(left, field.attribute) for field in VIEW.values())
    assert (back.speed, back.energy_account) == (float(chosen["speed"]), chosen["account"] == "on")


@given(st.text(max_size=200))
def test_no_query_string_breaks_the_page(query: str) -> None:
    back, fields, refused = decode(query)
    assert back.N >= 1 and isinstance(fields, dict) and all(isinstance(s, str) for s in refused)


def test_a_link_of_unreasonable_length_is_not_read() -> None:
    assert "longer than" in decode("f=" + "1" * LONGEST_LINK)[2][0]


@given(name=st.sampled_from(scene_names()), beads=st.integers(1, MOST_BEADS_IN_LINK), f=st.floats(0.1, 1e6),
       amplitude=st.floats(1e-12, 1e-4), damping=st.floats(0.0, 1e6), stiffness=st.floats(0.0, 1e10),
       pins=st.integers(0, len(NAMES)), started=st.integers(0, 15), seed=st.integers(0, 1000))
def test_every_link_that_is_made_can_be_read(name: str, beads: int, f: float, amplitude: float, damping: float,
                                             stiffness: float, pins: int, started: int, seed: int) -> None:
    """This includes links with every field, of the longest chains whose states fit, with the browser's additions."""
    shown = scene(name).evolve(f=f, A0=amplitude, D=damping, k=stiffness, N=beads, dissipation="kuwabara-kono",
                               tension="cut", accuracy=1.2345678901234567e-7, F0=1.2345678901234567)
    rng = np.random.default_rng(seed)
    states = [State(1e-6 * rng.standard_normal(beads), 1e-2 * rng.standard_normal(beads), 1234 / 9999)
              if started >> place & 1 else None for place in range(1 + pins)]
    left = Session(shown, start="previous", scale="fit", speed=0.25, energy_account=True, curves="rest.up.down.features",
                   initial_state=states[0], story="coexisting.2", pins=tuple(Pin(shown, one) for one in states[1:]),
                   question="strobes?knob=A0&from=1.23456789012345e-07&to=1.23456789012345e-06&values=199&keep=499")
    back = Session()
    start, refused = apply_address(back, left.link + "&tab=stability&page=stability&look=projector&embed=1")
    assert refused == [] and back.scene == shown and back.question == left.question
    assert (start is None) == (states[0] is None)
    assert len(back.pins) == pins_in(left.link) and (len(back.pins) == pins) == (left.pins_left_out == "")


def test_a_page_that_is_only_a_tab_is_opened_by_either_name() -> None:
    session = Session()
    assert apply_address(session, "v=1&page=map")[1] == [] and session.place == {"tab": "map"}
    assert apply_address(session, "v=1&page=stability")[1] == [] and session.place == {"page": "stability"}


def test_a_page_is_opened_by_its_former_name() -> None:
    session = Session()
    assert apply_address(session, "v=1&tab=hard&page=hard")[1] == []
    assert session.place == {"tab": "hard-cases", "page": "hard-cases"}


def test_a_link_with_a_story_alone_shows_the_motion_of_its_step() -> None:
    session = Session()
    step = story_step("coexisting.2", overlay_names())
    assert apply_address(session, "story=coexisting.2&look=dark")[1] == []
    assert session.scene == step.scene and session.story_to_settle  # it comes from 860 Hz
    apply_address(session, "story=sonic-vacuum.3")
    assert session.scene == story_step("sonic-vacuum.3", overlay_names()).scene and not session.story_to_settle
    apply_address(session, "story=coexisting.2&f=500")  # the page's own links include the motion
    assert session.scene.f == 500.0 and not session.story_to_settle


def test_pins_without_room_are_left_out_with_a_sentence() -> None:
    rng = np.random.default_rng(3)
    long = scene("sec2").evolve(N=MOST_BEADS_IN_LINK)
    start = State(rng.standard_normal(MOST_BEADS_IN_LINK) * 1e-6, rng.standard_normal(MOST_BEADS_IN_LINK) * 1e-2)
    full = Session(long, initial_state=start, pins=(Pin(long, start),) * 3)
    knobs = {"f": 123.45678901234567, "A0": 1.2345678901234567e-7, "D": 12.345678901234567, "k": 12345.678901234567,
             "F0": 1.2345678901234567, "accuracy": 1.2345678901234567e-7, "taper": 1.0123456789012345,
             "dimer": 0.34567890123456789, "striker": 1.0123456789012345, "site": 12, "impurity": 0.23456789012345678,
             "dissipation": "kuwabara-kono", "tension": "cut", "wall": 1.2345678901234567}
    fuller = Session(long.evolve(**knobs), initial_state=start, pins=(Pin(long.evolve(**knobs), start),) * 3)
    assert (full.pins_left_out == "") == (pins_in(full.link) == 3)
    assert pins_in(fuller.link) == 2 and fuller.pins_left_out.startswith("The link has room for 2 of 3 pins")


@pytest.mark.parametrize("wrong", [True, None, "5", 3.0, 0.0, float("nan"), [1]])
def test_a_speed_is_one_of_the_list(wrong: object) -> None:
    session = Session()
    for speed in SPEEDS:
        session.set_speed(speed)
        assert decode(session.link)[1].get("speed", "1") == f"{session.speed:g}"
    with pytest.raises(BadInput, match=r"is not one of 0\.1, 0\.25, 0\.5, 1, 2, 5, 20, 100 drive periods"):
        session.set_speed(wrong)
    assert session.speed == SPEEDS[-1]


def test_every_choice_of_curves_is_restored_from_a_link() -> None:
    for chosen in ([], ["rest"], ["down", "up"], ["features", "down", "up", "rest"]):
        _, fields, refused = decode(encode(scene("sec2"), {"curves": joined(chosen)}))
        assert refused == [] and {*fields["curves"].split(".")} == ({*chosen} or {"none"})
    _, fields, refused = decode("v=1&curves=rest.sideways")
    assert fields == {} and "rest.sideways" in refused[0]


def test_the_page_has_settings_of_its_own() -> None:
    _, fields, refused = decode("v=1&tab=map", {"tab": ("map", "data")})
    assert (fields, refused) == ({"tab": "map"}, [])
    _, fields, refused = decode("v=1&tab=nap", {"tab": ("map", "data")})
    assert fields == {} and "not one of map, data" in refused[0]
