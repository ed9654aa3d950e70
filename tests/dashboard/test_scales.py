"""One scale for all pictures of a scene or one for each picture, and the basis of a scene's scale."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import pytest

from app.dashboard.scales import DIGEST, FILE, PictureScales
from app.frames import samples_for, settled_frames
from app.parts.chain.chain import energy_labels, frames_message
from app.session.session import Session
from granchain_core import Scene, scene, scene_names, settle
from tools.scales import digest_of, over_frequencies


def frames_at(chain: Scene):
    return settled_frames(settle(chain, samples=samples_for(chain)).run)


LOUD, QUIET = (scene("sec2").evolve(f=f) for f in (1130.0, 2500.0))


def test_pictures_of_a_scene_share_a_scale_and_a_larger_one_widens_it() -> None:
    scales = PictureScales(Session())
    first = scales.of(frames_at(LOUD), LOUD)
    assert scales.of(frames_at(QUIET), QUIET) == first
    driven = LOUD.evolve(A0=2e-6)
    wider = scales.of(frames_at(driven), driven)
    assert wider.output_force > first.output_force
    assert scales.of(frames_at(QUIET), QUIET) == wider
    scales.forget()
    assert scales.of(frames_at(QUIET), QUIET) == first


def test_a_fitted_picture_is_drawn_to_its_own_values() -> None:
    scales = PictureScales(Session(scale="fit"))
    frames = frames_at(QUIET)
    own = scales.of(frames, QUIET)
    assert own == frames.extremes
    assert own.kinetic_energy < 0.05 * PictureScales(Session()).of(frames, QUIET).kinetic_energy
    message = frames_message(1, frames, QUIET, own, True, [], False, False, True)
    assert message["scale"] is None


def test_every_scene_has_a_scale() -> None:
    tables = tomllib.loads(FILE.read_text(encoding="utf-8"))
    assert sorted(tables) == sorted(scene_names())


def test_a_digest_is_of_the_physics_and_of_the_range_of_f() -> None:
    chain = scene("sec2")
    others = [chain.evolve(A0=1.01 * chain.A0), chain.evolve(wall="rigid"), replace(chain, ranges=(("f", 100.0, 200.0),))]
    assert len({digest_of(one) for one in (chain, *others)}) == 4
    assert digest_of(replace(chain, name="mine", title="Mine", look_at="", paper="")) == digest_of(chain)


def test_the_scale_of_a_scene_fits_its_motion() -> None:
    """It is computed again at every frequency; the file keeps three digits."""
    told = tomllib.loads(FILE.read_text(encoding="utf-8"))["sec2"]
    told.pop(DIGEST)
    assert told == pytest.approx(dict(over_frequencies(scene("sec2")).items()), rel=5e-3)


def test_the_middle_of_the_colour_bar_is_a_quarter_of_its_end() -> None:
    assert energy_labels(4e-7) == ["0", "100", "400 nJ"]


def test_an_overlap_counts_driver_and_wall() -> None:
    frames = frames_at(LOUD)
    pressed = replace(frames, drive_displacement=frames.displacement[:, 0] + 1e-3)
    assert pressed.extremes.overlap == pytest.approx(1e-3)
