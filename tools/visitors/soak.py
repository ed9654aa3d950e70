"""Visits that open, move and leave over a long time, and the server's memory, descriptors and threads."""

from __future__ import annotations

import asyncio
import os
import random
import time
from pathlib import Path

import numpy as np

from .started import Started
from .visitor import Visitor

#: Number of simultaneous visitors.
_AT_ONCE = 4
#: Visits between two rows of the table. They use forty frequencies, whose pictures are soon all cached.
_EVERY = 25


async def run(server: Started, minutes: float, seed: int) -> None:
    """Visit for `minutes`, print a row from time to time and, at the end, the slopes over the second half."""
    rows: list[tuple[int, float, int, int]] = []
    end, visits, chance = time.monotonic() + 60.0 * minutes, 0, random.Random(seed)
    print("visits | memory MB | descriptors | threads | load")
    while time.monotonic() < end:
        await asyncio.gather(*(_visit(server.address, random.Random(chance.random())) for _ in range(_AT_ONCE)))
        visits += _AT_ONCE
        if visits % _EVERY < _AT_ONCE:
            rows.append((visits, *figures(server.number)))
            print(f"{visits} | {rows[-1][1]:.1f} | {rows[-1][2]} | {rows[-1][3]} | {os.getloadavg()[0]:.1f}", flush=True)
    half = np.array(rows[len(rows) // 2 :], dtype=float)
    if len(half) > 2:
        slopes = [float(np.polyfit(half[:, 0], half[:, column], 1)[0]) for column in (1, 2, 3)]
        print(f"a visit in the second half: {slopes[0]:.4f} MB, {slopes[1]:.4f} descriptors, {slopes[2]:.4f} threads")


async def _visit(address: str, chance: random.Random) -> None:
    visitor = Visitor(address)
    await visitor.open()
    for _ in range(3):
        await visitor.move("f", 300.51 + 10 * chance.randrange(40))
    if chance.random() < 0.5:  # half of them leave during a computation
        await visitor.say(do="set", name="N", value=chance.randrange(8, 12), seq=2)
    await visitor.leave()


def figures(process: int) -> tuple[float, int, int]:
    """Return resident memory [MB], open descriptors and threads of a process."""
    words = dict(line.split(":", 1) for line in Path(f"/proc/{process}/status").read_text().splitlines() if ":" in line)
    return int(words["VmRSS"].split()[0]) / 1024, len(os.listdir(f"/proc/{process}/fd")), int(words["Threads"])
