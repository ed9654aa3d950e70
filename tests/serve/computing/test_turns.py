"""Fair turns: the visitor who has used the least processor time is next, and a long computation delays nobody."""

from __future__ import annotations

import threading

import pytest
from waiting import until

from app.serve.computing.cpu_time import CpuTime, SharedCpuTime
from app.serve.computing.turns import TurnFlag, Turns
from granchain_core import Stop

pytestmark = pytest.mark.quick


def test_used_time_is_halved_every_five_seconds() -> None:
    now = [0.0]
    cpu_time = CpuTime(lambda: now[0])
    cpu_time.charge(2.0)
    now[0] = 5.0
    assert cpu_time.used == 1.0
    cpu_time.charge(1.0)
    now[0] = 10.0
    assert cpu_time.used == 1.0


def test_shared_computation_charges_members_and_ranks_by_the_least_used() -> None:
    most, least, shared = CpuTime(lambda: 0.0), CpuTime(lambda: 0.0), SharedCpuTime()
    most.charge(8.0)
    shared.members += [most, least]
    assert shared.used == 0.0
    shared.charge(2.0)
    assert (most.used, least.used, shared.used) == (9.0, 1.0, 1.0)


def test_a_stopped_computation_leaves_the_queue_before_the_next_check(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.serve.computing.turns._CHECK_INTERVAL", 3600.0)
    turns = Turns(1, lambda: 0.0)
    held = turns.begin(CpuTime(), Stop())
    flags = [TurnFlag(CpuTime(), turns) for _ in range(3)]
    begun: list[TurnFlag] = []

    def wait(flag: TurnFlag) -> None:
        with flag.held():
            begun.append(flag)

    threads = [threading.Thread(target=wait, args=(flag,), daemon=True) for flag in flags]
    for number, thread in enumerate(threads, 1):
        thread.start()
        until(lambda number=number: turns.waiting == number)
    flags[1].set()
    threads[1].join(60)
    assert not threads[1].is_alive() and turns.waiting == 2 and begun == [flags[1]]
    turns.end(held)
    for thread in threads:
        thread.join(60)
    assert len(begun) == 3 and turns.waiting == 0


def test_the_visitor_who_has_used_least_gets_the_next_turn() -> None:
    """It is not the one that came first. The clock is stopped, because the first turn would give way after 0.1 s."""
    turns, order = Turns(1, lambda: 0.0), []
    first = turns.begin(CpuTime(), Stop())
    cpu_times = {}
    for name, used in (("much", 3.0), ("little", 0.1), ("some", 1.0)):
        cpu_times[name] = CpuTime()
        cpu_times[name].charge(used)

    def wait(name: str) -> None:
        turn = turns.begin(cpu_times[name], Stop())
        order.append(name)
        turns.end(turn)

    threads = [threading.Thread(target=wait, args=(name,)) for name in cpu_times]
    for number, thread in enumerate(threads, 1):
        thread.start()
        until(lambda number=number: turns.waiting == number)
    turns.end(first)
    for thread in threads:
        thread.join(60)
    assert order == ["little", "some", "much"]


def order_of(turns: Turns, waits: list[tuple[str, float, bool]]) -> list[str]:
    """Return the order in which waiting computations (name, time used, whether new) get their turns."""
    order: list[str] = []
    first, threads = turns.begin(CpuTime(), Stop()), []
    for number, (name, used, is_new) in enumerate(waits, 1):
        cpu_time = CpuTime()
        cpu_time.charge(used)

        def wait(name: str = name, cpu_time: CpuTime = cpu_time, is_new: bool = is_new) -> None:
            turn = turns.begin(cpu_time, Stop(), is_new)
            order.append(name)
            turns.end(turn)

        threads.append(threading.Thread(target=wait))
        threads[-1].start()
        until(lambda number=number: turns.waiting == number)
    turns.end(first)
    for thread in threads:
        thread.join(60)
    return order


def test_first_pictures_go_before_refinements() -> None:
    """Among equals, the visitor who has used less comes first."""
    waits = [("refinement", 0.0, False), ("first, much", 3.0, True), ("first, little", 1.0, True),
             ("refinement, much", 5.0, False)]
    assert order_of(Turns(1, lambda: 0.0), waits) == ["first, little", "first, much", "refinement", "refinement, much"]


def used_time(used: float) -> CpuTime:
    """Return the processor time of a visitor who has used this much, without halving."""
    found = CpuTime(lambda: 0.0)
    found.charge(used)
    return found


def waiting_threads(turns: Turns, *cpu_times: CpuTime, is_new: bool = False) -> list[threading.Thread]:
    """Start threads that wait for a turn, one for each visitor, and end the turn as soon as they have it."""
    found = [threading.Thread(target=lambda one=one: turns.end(turns.begin(one, Stop(), is_new)), daemon=True)
             for one in cpu_times]
    for thread in found:
        thread.start()
    until(lambda: turns.waiting == len(cpu_times))
    return found


def test_after_its_slice_a_turn_goes_to_a_visitor_who_has_used_less() -> None:
    now = [0.0]
    turns = Turns(1, lambda: now[0])
    turn = turns.begin(used_time(5.0), Stop(), False)
    thread, = waiting_threads(turns, used_time(1.0))
    assert not turns.should_yield(turn)
    now[0] = 0.05
    assert turns.should_yield(turn)
    turns.end(turn)
    thread.join(60)


def test_a_turn_does_not_go_to_a_visitor_who_has_used_more() -> None:
    now = [0.0]
    turns = Turns(1, lambda: now[0])
    turn = turns.begin(used_time(1.0), Stop(), False)
    thread, = waiting_threads(turns, used_time(5.0))
    now[0] = 0.05
    assert not turns.should_yield(turn)
    turns.end(turn)
    thread.join(60)


def test_at_a_pause_the_turn_is_passed_on() -> None:
    now = [0.0]
    turns = Turns(1, lambda: now[0])
    flag = TurnFlag(used_time(5.0), turns)
    list(flag.in_turns([1]))
    with flag.held():
        thread, = waiting_threads(turns, used_time(1.0))
        flag.pause()
        assert turns.waiting == 1
        now[0] = 0.05
        flag.pause()
        thread.join(60)
        assert not thread.is_alive()


def test_a_first_picture_does_not_wait_for_a_refinement_and_is_not_interrupted() -> None:
    """As many first pictures run at once as there are cores."""
    now = [0.0]
    turns = Turns(1, lambda: now[0])
    turns.begin(used_time(0.0), Stop(), False)
    begun = []
    threading.Thread(target=lambda: begun.append(turns.begin(used_time(9.0), Stop())), daemon=True).start()
    until(lambda: bool(begun))
    first = begun[0]
    thread, = waiting_threads(turns, used_time(0.0), is_new=True)
    now[0] = 0.05
    assert not turns.should_yield(first)
    turns.end(first)
    thread.join(60)
    assert not thread.is_alive()


def test_a_computation_with_a_result_no_longer_counts_as_just_begun() -> None:
    flag, seen = TurnFlag(CpuTime(), Turns(1)), []
    for _ in flag.in_turns(seen.append(flag.is_new) for _ in range(3)):
        pass
    assert seen == [True, False, False]


def test_a_computation_that_has_made_progress_makes_room_for_a_first_picture() -> None:
    """It may continue after its pause, and the first picture gets a turn in addition."""
    turns = Turns(1, lambda: 0.0)
    turn = turns.begin(used_time(0.0), Stop())
    thread, = waiting_threads(turns, used_time(0.0), is_new=True)
    turns.became_refinement(turn)
    assert not turns.should_yield(turn)
    thread.join(60)
    assert not thread.is_alive()


def test_a_refinement_that_has_waited_half_a_second_gets_a_slice_beside_first_pictures() -> None:
    now = [0.0]
    turns = Turns(1, lambda: now[0])
    first = turns.begin(used_time(0.0), Stop())
    thread, = waiting_threads(turns, used_time(5.0))
    now[0] = 0.6
    first.at = 0.6  # not old enough to be disregarded
    thread.join(60)
    assert not thread.is_alive()


def test_of_more_computations_than_turns_the_one_that_has_used_most_yields_after_its_slice() -> None:
    """An old turn delays nobody, but would share the cores with computations that started later."""
    now = [0.0]
    turns = Turns(1, lambda: now[0])
    long = turns.begin(used_time(5.0), Stop(), False)
    now[0] = 1.0
    assert not turns.should_yield(long)
    other = turns.begin(used_time(1.0), Stop(), False)
    now[0] = 1.05
    assert turns.should_yield(long) and not turns.should_yield(other)
    turns.end(other)
    assert not turns.should_yield(long)


def test_a_computation_that_never_pauses_does_not_block_others() -> None:
    """This is true for any number of them."""
    turns = Turns(2)
    for _ in range(20):
        turns.begin(CpuTime(), Stop())
    got = threading.Event()
    threading.Thread(target=lambda: (turns.begin(CpuTime(), Stop()), got.set()), daemon=True).start()
    assert got.wait(60)


def test_a_visitor_who_left_does_not_wait_for_a_turn() -> None:
    turns, stop, ended = Turns(1), Stop(), threading.Event()
    turns.begin(CpuTime(), Stop())
    stop.set()
    threading.Thread(target=lambda: (turns.begin(CpuTime(), stop), ended.set()), daemon=True).start()
    assert ended.wait(60)
    assert turns.waiting == 0
