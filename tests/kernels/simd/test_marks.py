"""The mark of a slot names the SIMD kernels that know it; for all others, the slot counts as unknown."""

from __future__ import annotations

from typing import NamedTuple

import pytest

from granchain_core import scene
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.effects import registry


class Slot(NamedTuple):
    """An effect that only some kernels know."""

    value: float


def test_kernels_outside_the_mark_have_no_code_for_the_slot(monkeypatch: pytest.MonkeyPatch) -> None:
    for folder, known in registry._IN_SIMD_KERNELS.items():
        monkeypatch.setitem(registry._IN_SIMD_KERNELS, folder, set(known))
    slots = scale_chain(scene("sec2")).slots._replace(foundation=Slot(1.0))
    assert registry.in_simd_kernels("rk4", "batch")(Slot) is Slot
    assert [registry.unknown_slots(slots, folder) for folder in ("rk4", "batch", "dop853_root")] == [[], [], ["foundation"]]


@pytest.mark.parametrize("slots", [{"kappa": 0.01, "F0": 1.0}, {"dissipation": "none"}], ids=str)
def test_known_effects_are_accepted_present_or_absent(slots: dict[str, object]) -> None:
    present = scale_chain(scene("sec2").evolve(**slots)).slots  # type: ignore[arg-type]
    assert registry.unknown_slots(present, "dop853_root") == []


@pytest.mark.parametrize("folders", [("rk5",), (Slot,)], ids=str)
def test_a_mark_without_folders_of_kernels_is_refused(folders: tuple[object, ...]) -> None:
    """The second case is the mark without parentheses, which would mean that all of them know the slot."""
    with pytest.raises(TypeError, match="is not a folder of SIMD kernels; name those with terms of the slot, of rk4, batch"):
        registry.in_simd_kernels(*folders)
