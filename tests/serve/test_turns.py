"""Fair turns: who has used least time is next, a bomb keeps nobody waiting, a visitor who left is not waited for."""

from __future__ import annotations

import threading

import pytest
from waiting import until

from app.serve.cpu_time import CpuTime, SharedCpuTime
from app.serve.turns import FairScheduler, TurnFlag
from granchain_core import Stop

pytestmark = pytest.mark.quick


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


def test_who_is_stopped_while_waiting_does_not_wait_for_the_next_look(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.serve.turns._CHECK_INTERVAL", 3600.0)
    turns = FairScheduler(1, lambda: 0.0)
    held = turns.begin(CpuTime(), Stop())
    slots = [TurnFlag(CpuTime(), turns) for _ in range(3)]
    begun: list[TurnFlag] = []

    def wait(slot: TurnFlag) -> None:
        with slot.held():
            begun.append(slot)

    threads = [threading.Thread(target=wait, args=(slot,), daemon=True) for slot in slots]
    for number, thread in enumerate(threads, 1):
        thread.start()
        until(lambda number=number: turns.waiting == number)
    slots[1].set()
    threads[1].join(60)
    assert not threads[1].is_alive() and turns.waiting == 2 and begun == [slots[1]]
    turns.end(held)
    for thread in threads:
        thread.join(60)
    assert len(begun) == 3 and turns.waiting == 0


def test_of_those_who_wait_the_one_that_has_used_least_is_next() -> None:
    """Not the one that came first. The clock stands still: after a tenth of a second the first turn would make room."""
    turns, order = FairScheduler(1, lambda: 0.0), []
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
        thread.join(60)
    assert order == ["little", "some", "much"]


def order_of(turns: FairScheduler, waits: list[tuple[str, float, bool]]) -> list[str]:
    """In which order those who wait get their turns: name, time used, whether the computation has just begun."""
    order: list[str] = []
    first, threads = turns.begin(CpuTime(), Stop()), []
    for number, (name, used, is_new) in enumerate(waits, 1):
        account = CpuTime()
        account.charge(used)

        def wait(name: str = name, account: CpuTime = account, is_new: bool = is_new) -> None:
            turn = turns.begin(account, Stop(), is_new)
            order.append(name)
            turns.end(turn)

        threads.append(threading.Thread(target=wait))
        threads[-1].start()
        until(lambda number=number: turns.waiting == number)
    turns.end(first)
    for thread in threads:
        thread.join(60)
    return order


def test_what_has_just_begun_goes_before_what_only_makes_a_picture_better() -> None:
    """Among each, who has used less."""
    waits = [("better", 0.0, False), ("first, much", 3.0, True), ("first, little", 1.0, True),
             ("better, much", 5.0, False)]
    assert order_of(FairScheduler(1, lambda: 0.0), waits) == ["first, little", "first, much", "better", "better, much"]


def account(used: float) -> CpuTime:
    """Of a visitor who has used so much, which is not forgotten."""
    found = CpuTime(lambda: 0.0)
    found.charge(used)
    return found


def waiting_threads(turns: FairScheduler, *accounts: CpuTime, is_new: bool = False) -> list[threading.Thread]:
    """Threads that wait for a turn, one for each account, and end it as soon as they have it."""
    found = [threading.Thread(target=lambda one=one: turns.end(turns.begin(one, Stop(), is_new)), daemon=True)
             for one in accounts]
    for thread in found:
        thread.start()
    until(lambda: turns.waiting == len(accounts))
    return found


def test_after_its_slice_a_turn_goes_to_who_has_used_less() -> None:
    now = [0.0]
    turns = FairScheduler(1, lambda: now[0])
    turn = turns.begin(account(5.0), Stop(), False)
    thread, = waiting_threads(turns, account(1.0))
    assert not turns.should_yield(turn, False)
    now[0] = 0.05
    assert turns.should_yield(turn, False)
    turns.end(turn)
    thread.join(60)


def test_a_turn_does_not_go_to_who_has_used_more() -> None:
    now = [0.0]
    turns = FairScheduler(1, lambda: now[0])
    turn = turns.begin(account(1.0), Stop(), False)
    thread, = waiting_threads(turns, account(5.0))
    now[0] = 0.05
    assert not turns.should_yield(turn, False)
    turns.end(turn)
    thread.join(60)


def test_at_a_pause_the_turn_is_passed_on() -> None:
    now = [0.0]
    turns = FairScheduler(1, lambda: now[0])
    slot = TurnFlag(account(5.0), turns)
    list(slot.in_turns([1]))
    with slot.held():
        thread, = waiting_threads(turns, account(1.0))
        slot.pause()
        assert turns.waiting == 1
        now[0] = 0.05
        slot.pause()
        thread.join(60)
        assert not thread.is_alive()


def test_what_has_just_begun_waits_for_nothing_that_takes_long_and_is_not_interrupted() -> None:
    """Of those, too, as many at once as there are cores."""
    now = [0.0]
    turns = FairScheduler(1, lambda: now[0])
    turns.begin(account(0.0), Stop(), False)
    begun = []
    threading.Thread(target=lambda: begun.append(turns.begin(account(9.0), Stop())), daemon=True).start()
    until(lambda: bool(begun))
    first = begun[0]
    thread, = waiting_threads(turns, account(0.0), is_new=True)
    now[0] = 0.05
    assert not turns.should_yield(first, True)
    turns.end(first)
    thread.join(60)
    assert not thread.is_alive()


def test_a_computation_with_a_result_has_no_longer_just_begun() -> None:
    slot, seen = TurnFlag(CpuTime(), FairScheduler(1)), []
    for _ in slot.in_turns(seen.append(slot.is_new) for _ in range(3)):
        pass
    assert seen == [True, False, False]


def test_a_turn_that_has_become_long_makes_room_for_what_begins() -> None:
    """Asked at its pause the long turn may go on, and what begins gets a turn beside it."""
    turns = FairScheduler(1, lambda: 0.0)
    turn = turns.begin(account(0.0), Stop())
    thread, = waiting_threads(turns, account(0.0), is_new=True)
    assert not turns.should_yield(turn, False)
    thread.join(60)
    assert not thread.is_alive()


def test_who_has_waited_for_half_a_second_has_a_slice_beside_those_who_begin() -> None:
    now = [0.0]
    turns = FairScheduler(1, lambda: now[0])
    first = turns.begin(account(0.0), Stop())
    thread, = waiting_threads(turns, account(5.0))
    now[0] = 0.6
    first.at = 0.6  # not so old that it does not count
    thread.join(60)
    assert not thread.is_alive()


def test_of_more_than_there_are_turns_the_one_that_has_used_most_goes_after_its_slice() -> None:
    """A turn that is old keeps nobody waiting, but would share the cores with who came after it."""
    now = [0.0]
    turns = FairScheduler(1, lambda: now[0])
    bomb = turns.begin(account(5.0), Stop(), False)
    now[0] = 1.0
    assert not turns.should_yield(bomb, False)
    other = turns.begin(account(1.0), Stop(), False)
    now[0] = 1.05
    assert turns.should_yield(bomb, False) and not turns.should_yield(other, False)
    turns.end(other)
    assert not turns.should_yield(bomb, False)


def test_a_turn_that_never_pauses_keeps_nobody_waiting() -> None:
    """As many as have turns at once and more."""
    turns = FairScheduler(2)
    for _ in range(20):
        turns.begin(CpuTime(), Stop())
    got = threading.Event()
    threading.Thread(target=lambda: (turns.begin(CpuTime(), Stop()), got.set()), daemon=True).start()
    assert got.wait(60)


def test_who_left_does_not_wait_for_a_turn() -> None:
    turns, stop, ended = FairScheduler(1), Stop(), threading.Event()
    turns.begin(CpuTime(), Stop())
    stop.set()
    threading.Thread(target=lambda: (turns.begin(CpuTime(), stop), ended.set()), daemon=True).start()
    assert ended.wait(60)
    assert turns.waiting == 0
