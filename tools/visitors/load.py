"""Visitors who each move a knob once a second, and the time until its picture arrives."""

from __future__ import annotations

import asyncio
import os
import random
import time

from .soak import figures
from .started import Started
from .visitor import Visitor, query_of

#: A heavy client; nine of them once kept everybody else from any picture for a minute.
HEAVY = query_of(N=10000, f=0.1, A0=1e-4)
_HEAVY_CLIENTS = 9


class Answers:
    """The experience of one run's visitors: times until a picture [s], moves not answered before the next."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.late = 0
        self.openings: list[float] = []

    def part(self, share: float, times: list[float]) -> float:
        """Return the time below which this share of the times is [ms]."""
        return 1e3 * sorted(times)[min(len(times) - 1, int(share * len(times)))] if times else float("nan")

    @property
    def row(self) -> str:
        """The row of the table."""
        return (f"{self.part(0.5, self.times):.0f} | {self.part(0.95, self.times):.0f} | {len(self.times)} | {self.late} | "
                f"{self.part(0.5, self.openings) / 1e3:.2f} | {max(self.openings, default=float('nan')):.2f}")


async def run(server: Started, count: int, minutes: float, heavy: bool, same: bool, seed: int) -> None:
    """Open the pages, move for `minutes`, and print a row of the table in docs/reliability.md."""
    answers, clients = Answers(), [Visitor(server.address, HEAVY) for _ in range(_HEAVY_CLIENTS if heavy else 0)]
    for one in clients:
        asyncio.get_running_loop().create_task(_insist(one))
    memory = figures(server.number)[0] if server.process else float("nan")
    visitors = [Visitor(server.address) for _ in range(count)]
    began, loop = time.perf_counter(), server.loop_time if server.process else float("nan")
    await asyncio.gather(*(one.open() for one in visitors))
    all_open = time.perf_counter() - began
    answers.openings = [one.opened_in for one in visitors]
    opening = (server.loop_time - loop) / count if server.process else float("nan")
    await asyncio.sleep(3.0)
    load, used = os.getloadavg()[0], server.processor_time if server.process else 0.0
    loop = server.loop_time if server.process else float("nan")
    own = time.process_time()
    end = time.perf_counter() + 60.0 * minutes
    await asyncio.gather(*(_moves(one, end, random.Random(seed if same else f"{seed} {number}"), answers, same)
                           for number, one in enumerate(visitors)))
    used = (server.processor_time - used) / (60.0 * minutes) if server.process else float("nan")
    own = (time.process_time() - own) / (60.0 * minutes)
    move = (server.loop_time - loop) / max(1, len(answers.times)) if server.process else float("nan")
    after = figures(server.number)[0] if server.process else float("nan")
    print("visitors | heavy clients | p50 ms | p95 ms | answered | after a second | opening p50 s | slowest opening s | all open s "
          "| processors used | by the visitors | loop ms per move | loop ms per opening | memory before MB | with all MB | load before")
    print(f"{count} | {'yes' if heavy else 'no'} | {answers.row} | {all_open:.1f} | {used:.2f} | {own:.2f} | {1e3 * move:.1f} "
          f"| {1e3 * opening:.0f} | {memory:.0f} | {after:.0f} | {load:.1f}", flush=True)
    await asyncio.gather(*(one.leave() for one in [*visitors, *clients]))


async def _moves(visitor: Visitor, end: float, chance: random.Random, answers: Answers, same: bool) -> None:
    """Make one move per second; with `same`, all visitors move at the same instants."""
    if not same:
        await asyncio.sleep(chance.random())
    due = time.perf_counter()
    while due < end:
        taken = await visitor.move("f", 300.0 + chance.randrange(1, 5000) / 10 + 0.01)
        if taken is None:
            answers.late += 1
        else:
            answers.times.append(taken)
            answers.late += taken > 1.0
        due = max(due + 1.0, time.perf_counter())
        await asyncio.sleep(max(0.0, due - time.perf_counter()))


async def _insist(visitor: Visitor) -> None:
    """Open a page whose picture takes hours, and press the button that asks for it nevertheless."""
    opening = asyncio.get_running_loop().create_task(visitor.open(3600.0))
    for _ in range(100):
        await asyncio.sleep(1.0)
        if any("would take" in said for said in visitor.sentences):
            await visitor.say(do="insist")
            break
    await asyncio.wait([opening])
