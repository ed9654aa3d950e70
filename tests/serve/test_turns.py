"""Fair turns: who has used least time is next, a bomb keeps nobody waiting, a visitor who left is not waited for."""

from __future__ import annotations

import threading
import time

from app.serve.turns import CpuTime, FairScheduler, SchedulerSlot, SharedCpuTime
from granchain_core import Stop


def until(holds: object, seconds: float = 20.0) -> None:
    """Wait until something holds."""
    end = time.monotonic() + seconds
    while not holds():  # type: ignore[operator]
        assert time.monotonic() < end, "did not come"
        time.sleep(0.002)


def test_half_of_what_was_used_is_forgotten_in_five_seconds() -> None:
    now = [0.0]
    cpu_time = CpuTime(lambda: now[0])
    cpu_time.charge(2.0)
    now[0] = 5.0
    assert cpu_time.used == 1.0
    cpu_time.charge(1.0)
    now[0] = 10.0
    assert cpu_time.used == 1.0


def test_a_party_pays_together_and_has_the_claim_of_its_poorest() -> None:
    rich, poor, party = CpuTime(lambda: 0.0), CpuTime(lambda: 0.0), SharedCpuTime()
    rich.charge(8.0)
    party.members += [rich, poor]
    assert party.used == 0.0
    party.charge(2.0)
    assert (rich.used, poor.used, party.used) == (9.0, 1.0, 1.0)


def test_of_those_who_wait_the_one_that_has_used_least_is_next() -> None:
    """Not the one that came first."""
    turns, order = FairScheduler(1), []
    first = turns.begin(CpuTime(), Stop())
    accounts = {}
    for name, used in (("much", 3.0), ("little", 0.1), ("some", 1.0)):
        accounts[name] = CpuTime()
        accounts[name].charge(used)

    def wait(name: str) -> None:
        turn = turns.begin(accounts[name], Stop())
        order.append(name)
        turns.end(turn)

    threads = [threading.Thread(target=wait, args=(name,)) for name in accounts]
    for number, thread in enumerate(threads, 1):
        thread.start()
        until(lambda number=number: turns.waiting == number)
    turns.end(first)
    for thread in threads:
        thread.join(20)
    assert order == ["little", "some", "much"]


def order_of(turns: FairScheduler, waits: list[tuple[str, float, bool]], ready: object) -> list[str]:
    """In which order those who wait get their turns: name, time used, whether the computation has just begun."""
    order: list[str] = []
    first, threads = turns.begin(CpuTime(), Stop()), []
    for number, (name, used, begins) in enumerate(waits, 1):
        account = CpuTime()
        account.charge(used)

        def wait(name: str = name, account: CpuTime = account, begins: bool = begins) -> None:
            turn = turns.begin(account, Stop(), begins)
            order.append(name)
            turns.end(turn)

        threads.append(threading.Thread(target=wait))
        threads[-1].start()
        until(lambda number=number: turns.waiting == number)
    ready()  # type: ignore[operator]
    turns.end(first)
    for thread in threads:
        thread.join(20)
    return order


def test_what_has_just_begun_goes_before_what_only_makes_a_picture_better() -> None:
    """Among each, who has used less."""
    waits = [("better", 0.0, False), ("first, much", 3.0, True), ("first, little", 1.0, True), ("better, much", 5.0, False)]
    assert order_of(FairScheduler(1, lambda: 0.0), waits, lambda: None) == ["first, little", "first, much", "better", "better, much"]


def test_who_has_waited_for_half_a_second_waits_for_no_beginner() -> None:
    now = [0.0]

    def later() -> None:
        now[0] = 0.6

    assert order_of(FairScheduler(1, lambda: now[0]), [("better", 0.0, False), ("first", 1.0, True)], later) == ["better", "first"]


def test_at_a_pause_the_turn_goes_to_who_has_used_less() -> None:
    turns, done = FairScheduler(1), []
    mine = CpuTime()
    mine.charge(5.0)
    turn = SchedulerSlot(mine, turns)
    with turn.held():
        thread = threading.Thread(target=lambda: done.append(turns.begin(CpuTime(), Stop())))
        thread.start()
        until(lambda: turns.waiting == 1)
        threading.Timer(0.05, lambda: turns.end(done[0]) if done else None).start()
        turn.pause()
        assert done
    thread.join(20)


def test_of_more_than_there_are_turns_the_one_that_has_used_most_goes_at_its_pause() -> None:
    """A turn that is old keeps nobody waiting, but would share the cores with who came after it."""
    now = [0.0]
    turns, bomb, other = FairScheduler(1, lambda: now[0]), CpuTime(lambda: 0.0), CpuTime(lambda: 0.0)
    bomb.charge(5.0)
    turns.begin(bomb, Stop())
    assert not turns.should_yield(bomb, False)
    now[0] = 1.0
    turn = turns.begin(other, Stop())
    assert turns.should_yield(bomb, False) and not turns.should_yield(other)
    turns.end(turn)
    assert not turns.should_yield(bomb, False)


def test_a_turn_that_never_pauses_keeps_nobody_waiting() -> None:
    """As many as have turns at once and more."""
    turns = FairScheduler(2)
    for _ in range(20):
        turns.begin(CpuTime(), Stop())
    got = threading.Event()
    threading.Thread(target=lambda: (turns.begin(CpuTime(), Stop()), got.set()), daemon=True).start()
    assert got.wait(20)


def test_who_left_does_not_wait_for_a_turn() -> None:
    turns, stop, ended = FairScheduler(1), Stop(), threading.Event()
    turns.begin(CpuTime(), Stop())
    stop.set()
    threading.Thread(target=lambda: (turns.begin(CpuTime(), stop), ended.set()), daemon=True).start()
    assert ended.wait(20)
    assert turns.waiting == 0
