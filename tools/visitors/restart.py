"""A restart of a server with many pages, which all wait for it and open their links again, as browsers do."""

from __future__ import annotations

import asyncio
import os
import random
import time

from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest

from ..connection_times import connection_times, retry_growth
from .started import Started
from .visitor import Visitor, query_of

#: Pages that are opened at once before the restart.
_AT_ONCE = 20
#: Time between attempts to reach the server, first and longest [s], as a browser has them.
_RETRY_FIRST, _RETRY_LONGEST = (connection_times()[name][0] / 1000 for name in ("RETRY_FIRST", "RETRY_LONGEST"))
#: Time in which a browser loads the scripts of a page before it opens the websocket, at least and at most [s].
_SCRIPTS_TIME = (0.5, 1.5)
#: Time for all pages to come back [s].
_PATIENCE = 600.0


class Back:
    """The return of the pages: times since the restart [s], refusals, and attempts."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.asked = self.evicted = self.refused = 0
        self.ready_after = float("nan")


async def run(server: Started, count: int, seed: int) -> None:
    """Open the pages, restart the server, and print a row of the table in docs/reliability.md."""
    chance, back = random.Random(seed), Back()
    pages = [Visitor(server.address, query_of(f=300.5 + 0.25 * number), _SCRIPTS_TIME) for number in range(count)]
    for first in range(0, count, _AT_ONCE):
        await asyncio.gather(*(one.open() for one in pages[first:first + _AT_ONCE]))
    load = os.getloadavg()[0]
    began = time.perf_counter()
    restarted = asyncio.create_task(asyncio.to_thread(server.restart))
    await asyncio.gather(*(_come_back(one, began, random.Random(chance.random()), back) for one in pages))
    await restarted
    back.times.sort()
    print("pages | ready after s | half back after s | last back after s | lost their place | refused | asked for readiness | load")
    print(f"{count} | {back.ready_after:.1f} | {back.times[count // 2]:.1f} | {back.times[-1]:.1f} | {back.evicted} "
          f"| {back.refused} | {back.asked} | {load:.1f}", flush=True)
    await asyncio.gather(*(one.leave() for one in pages))


async def _come_back(page: Visitor, began: float, chance: random.Random, back: Back) -> None:
    """Wait until the connection is lost, and open the page again."""
    await page.lost()
    while True:
        await _until_ready(page.address, chance, back)
        if back.ready_after != back.ready_after:
            back.ready_after = time.perf_counter() - began
        try:
            await page.open(_PATIENCE)
            break
        except HTTPClientError as refused:
            if refused.code == 503:  # the page of that answer tries again after this time
                back.refused += 1
                await asyncio.sleep(float((refused.response.headers if refused.response else {}).get("Retry-After", 30)))
            else:
                back.evicted += 1
        except OSError:  # the server is not listening yet
            pass
    back.times.append(time.perf_counter() - began)


async def _until_ready(address: str, chance: random.Random, back: Back) -> None:
    """Ask at random instants, less and less often, whether there is room for a page."""
    pause, client = _RETRY_FIRST, AsyncHTTPClient(max_clients=1000)
    while True:
        await asyncio.sleep(pause * (0.5 + 0.5 * chance.random()))
        back.asked += 1
        try:
            await client.fetch(HTTPRequest(f"{address}/readiness", request_timeout=2.6, connect_timeout=2.6))
            return
        except (HTTPClientError, OSError):
            pause = min(retry_growth() * pause, _RETRY_LONGEST)
