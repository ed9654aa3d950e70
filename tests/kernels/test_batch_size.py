"""Batches of all sizes give the same results for every scene, on every machine."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import llvmlite.binding
import numba
import pytest
from llvmlite.binding.targets import FeatureMap
from numba.core import codegen

from granchain_core import BadInput, resonance_curve, scene
from granchain_core.kernels import batch_size

FREQUENCIES = [130.0, 255.0, 340.0, 470.0, 850.0, 1130.0, 1576.0, 2000.0, 2500.0]
#: Runs in a separate process, because kernels are compiled for one batch size.
OTHER = """
import json, sys
from granchain_core import resonance_curve, scene
found = resonance_curve(scene("sec2"), json.loads(sys.argv[1]), workers=1)
print(json.dumps([[p.regime.name, p.regime.period, p.max_output_force, p.force_errors.output] for p in found.points]))
"""


@pytest.mark.parametrize("other", sorted(set(batch_size.CHOICES) - {batch_size.BATCH_SIZE}))
def test_every_size_of_a_batch_gives_the_same_curve(other: int) -> None:
    printed = subprocess.run([sys.executable, "-c", OTHER, json.dumps(FREQUENCIES)], capture_output=True, text=True,
                             check=True, env={**os.environ, batch_size.VARIABLE: str(other)}).stdout
    here = resonance_curve(scene("sec2"), FREQUENCIES, workers=1).points
    compared = 0
    for mine, (regime, period, force, error) in zip(here, json.loads(printed), strict=True):
        assert (mine.regime.name, mine.regime.period) == (regime, period)
        if mine.force_errors.output is None or error is None:  # 130 Hz is quasi-periodic: no period to take a maximum over
            assert mine.force_errors.output is error
            continue
        assert mine.max_output_force == pytest.approx(force, rel=mine.force_errors.output + error)
        compared += 1
    assert compared == len(FREQUENCIES) - 1


@pytest.mark.quick
@pytest.mark.parametrize(("features", "name", "host", "wide"), [
    # Numba's settings list the features: neither the processor name nor this machine counts
    ("+avx2,+avx512f,+fma", None, {}, True),
    ("+avx2,-avx512f", None, {"avx512f": True}, False),
    ("+avx512fp16", "icelake-server", {"avx512f": True}, False),
    # they name only a processor: Numba keeps this machine's features, and four scenes work on every processor
    (None, "znver3", {"avx512f": True}, False),
    # they name neither: this machine counts
    (None, None, {"avx512f": True}, True),
    (None, None, {"avx512f": False}, False),
    (None, None, {}, False),
])
def test_avx512_is_that_of_the_machine_the_kernels_are_compiled_for(
        features: str | None, name: str | None, host: dict[str, bool], wide: bool,
        monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "CPU_FEATURES", features)
    monkeypatch.setattr(numba.config, "CPU_NAME", name)
    monkeypatch.setattr(llvmlite.binding, "get_host_cpu_features", lambda: FeatureMap(host))
    assert batch_size.has_avx512() == wide
    assert batch_size.size_from(None) == (8 if wide else 4)


@pytest.mark.quick
def test_without_avx_in_numbas_settings_there_is_no_avx512(monkeypatch: pytest.MonkeyPatch) -> None:
    """With NUMBA_ENABLE_AVX=0, Numba disables these instructions, and LLVM aborts the process if a kernel has one."""
    monkeypatch.setattr(numba.config, "CPU_FEATURES", None)
    monkeypatch.setattr(numba.config, "CPU_NAME", None)
    monkeypatch.setattr(numba.config, "ENABLE_AVX", 0)
    monkeypatch.setattr(llvmlite.binding, "get_host_cpu_features", lambda: FeatureMap({"avx512f": True}))
    assert not batch_size.has_avx512()


@pytest.mark.quick
def test_a_machine_with_unknown_features_has_no_avx512(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown() -> FeatureMap:
        raise RuntimeError

    monkeypatch.setattr(numba.config, "CPU_FEATURES", None)
    monkeypatch.setattr(numba.config, "CPU_NAME", None)
    monkeypatch.setattr(llvmlite.binding, "get_host_cpu_features", unknown)
    assert not batch_size.has_avx512()


@pytest.mark.quick
def test_with_unknown_features_a_batch_has_four_scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "CPU_FEATURES", None)
    monkeypatch.setattr(numba.config, "CPU_NAME", None)
    monkeypatch.delattr(codegen, "get_host_cpu_features")
    assert batch_size.size_from(None) == 4


@pytest.mark.quick
def test_the_size_of_a_batch_is_the_one_chosen() -> None:
    assert [batch_size.size_from(str(size)) for size in batch_size.CHOICES] == list(batch_size.CHOICES)
    allowed = " or ".join(map(str, batch_size.CHOICES))
    with pytest.raises(BadInput, match=f"GRANCHAIN_BATCH_SIZE is '7'; it may be {allowed}"):
        batch_size.size_from("7")


@pytest.mark.quick
def test_the_older_name_of_the_variable_still_works(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(batch_size.VARIABLE, raising=False)
    for size in batch_size.CHOICES:
        monkeypatch.setenv(batch_size.OLDER_VARIABLE, str(size))
        assert batch_size._batch_size_here() == size
    monkeypatch.setenv(batch_size.OLDER_VARIABLE, "7")
    with pytest.raises(BadInput, match="GRANCHAIN_LANES is '7'"):
        batch_size._batch_size_here()
    monkeypatch.setenv(batch_size.VARIABLE, str(batch_size.CHOICES[0]))
    assert batch_size._batch_size_here() == batch_size.CHOICES[0]
