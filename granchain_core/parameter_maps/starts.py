"""Cells of a parameter map as the starts of batches."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..steady.batch.job import Start
from .grid import Grid


def starts_of(grid: Grid, numbers: Iterable[int]) -> Iterator[Start]:
    """The cells with these numbers as starts from rest."""
    return (Start(grid.cell(number), number=number) for number in numbers)


def by_kernel(grid: Grid, numbers: Iterable[int]) -> list[list[int]]:
    """Group the cells by the kernel they share: where an axis reaches 0, or the beads are equal, an effect is off.

    The names of the effects and whether the beads are equal determine the group, because a map has one N; `structure`
    (precompile/warm.py) considers more.
    """
    groups: dict[tuple[bool, tuple[str, ...]], list[int]] = {}
    for number in numbers:
        cell = grid.cell(number)
        groups.setdefault((cell.is_uniform, tuple(cell.effects)), []).append(number)
    return list(groups.values())
