import os
import signal
import sys
import threading
import time
from concurrent.futures import Future
from multiprocessing import active_children
from pathlib import Path

import pytest

from labcal.errors import DeviceError, UnknownNameError, WorkerError
from labcal.run.executor import finished, open_executor, open_pool
from labcal.run.pool import TRIES_ALONE, TRIES_WITH_OTHERS

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no signals there")


def note(folder: Path, word: str) -> int:
    """Leave a file and return how many of that name there were."""
    earlier = len(list(folder.glob(f"{word}-*")))
    (folder / f"{word}-{earlier}").touch()
    return earlier


def square(number: int) -> int:
    return number**2


def square_after_kills(number: int, folder: Path, kills: int) -> int:
    """Kill the process that this runs in so many times."""
    if note(folder, f"case-{number}") < kills:
        os.kill(os.getpid(), signal.SIGKILL)
    return square(number)


def square_or_end(number: int, folder: Path, killer: int, how: int) -> int:
    """Square one number after the other; one of them ends the process, with a signal or a status."""
    note(folder, f"case-{number}")
    if number == killer:
        if how > 0:
            os._exit(how)
        os.kill(os.getpid(), -how)
    time.sleep(0.05)
    return square(number)


def square_where_memory_suffices(number: int, folder: Path) -> int:
    """Square a number the third time."""
    if note(folder, f"case-{number}") < TRIES_WITH_OTHERS:
        raise MemoryError
    return square(number)


def end(_number: int) -> None:
    os._exit(7)


def large(folder: Path) -> bytes:
    """Return so much that sending it takes a while; the first time the process is killed meanwhile."""
    if note(folder, "large") == 0:
        thread = threading.Thread(target=kill_while_sending, args=(threading.get_ident(),), daemon=True)
        thread.start()
    return bytes(100_000_000)


def kill_while_sending(sender: int) -> None:
    while sys._current_frames()[sender].f_code.co_name != "_send":  # of multiprocessing.connection
        time.sleep(0.0005)
    os.kill(os.getpid(), signal.SIGKILL)


def kill_this() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def unknown_name() -> None:
    raise UnknownNameError("lens", "brwn5", ("brown5",))


class StubbornError(Exception):
    def __init__(self, first: str, second: str) -> None:
        super().__init__(f"{first} {second}")


def stubborn() -> None:
    raise StubbornError("cannot be", "unpickled")


def tries(folder: Path, number: int) -> int:
    return len(list(folder.glob(f"case-{number}-*")))


def value(future: Future[int]) -> int | str:
    try:
        return future.result()
    except WorkerError as error:
        return error.how


def test_killed_processes_are_replaced_and_their_cases_done_again(tmp_path: Path) -> None:
    with open_executor(2) as pool:
        futures = [pool.submit(square_after_kills, n, tmp_path, n % 2) for n in range(4)]
        assert [future.result() for future in futures] == [0, 1, 4, 9]
    assert [tries(tmp_path, n) for n in range(4)] == [1, 2, 1, 2]


@pytest.mark.slow
def test_a_case_that_is_killed_again_and_again_is_done_in_the_end(tmp_path: Path) -> None:
    kills = TRIES_WITH_OTHERS + TRIES_ALONE - 1
    with open_executor(2) as pool:
        assert pool.submit(square_after_kills, 5, tmp_path, kills).result() == 25
    assert tries(tmp_path, 5) == kills + 1


@pytest.mark.parametrize(
    ("how", "words", "count"),
    [
        (-signal.SIGSEGV, "crashed with SIGSEGV", TRIES_WITH_OTHERS + 1),
        pytest.param(9, "with exit status 9", TRIES_WITH_OTHERS + 1, marks=pytest.mark.slow),
        pytest.param(
            -signal.SIGKILL,
            "killed by SIGKILL.* memory",
            TRIES_WITH_OTHERS + TRIES_ALONE,
            marks=pytest.mark.slow,
        ),
    ],
)
def test_only_the_case_that_ends_processes_is_given_up(
    tmp_path: Path, how: int, words: str, count: int
) -> None:
    with open_executor(2) as pool:
        cases = [(n, tmp_path, 2, how) for n in range(6)]
        found = dict(finished(pool, square_or_end, cases))
    assert [value(found[n]) for n in (0, 1, 3, 4, 5)] == [0, 1, 9, 16, 25]
    with pytest.raises(WorkerError, match=words):
        found[2].result()
    # Its neighbours were not disturbed: each was tried once.
    assert [tries(tmp_path, n) for n in range(6)] == [1, 1, count, 1, 1, 1]


def test_a_case_without_memory_is_tried_again_alone(tmp_path: Path) -> None:
    with open_executor(2) as pool:
        assert pool.submit(square_where_memory_suffices, 5, tmp_path).result() == 25
    assert tries(tmp_path, 5) == TRIES_WITH_OTHERS + 1


def test_where_nothing_goes_it_is_told_as_that(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("labcal.run.pool.MOST_FAILED", 1)
    what = "All worker processes end.*exit status 7.*labcal doctor"
    with open_executor(2) as pool:
        cases = [(n,) for n in range(3)]
        first, *others = [future for _, future in finished(pool, end, cases)]
    assert value(first) == "with exit status 7"
    with pytest.raises(DeviceError, match=what):
        value(others[-1])


def test_a_process_killed_within_its_result_is_noticed(tmp_path: Path) -> None:
    with open_pool(1) as pool:
        assert len(pool.submit(large, tmp_path).result(timeout=60)) == 100_000_000
    assert (tmp_path / "large-1").exists()


@pytest.mark.slow
def test_a_process_killed_while_it_has_nothing_to_do_is_no_case_s_fault(tmp_path: Path) -> None:
    with open_pool(1) as pool:
        for number in range(TRIES_WITH_OTHERS + TRIES_ALONE + 1):
            assert pool.submit(square_after_kills, number, tmp_path, 0).result() == square(number)
            for process in active_children():
                process.kill()
                process.join()
    assert tries(tmp_path, 0) == 1


def test_processes_killed_as_they_start_are_told_as_that(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("labcal.run.worker.prepare", kill_this)
    monkeypatch.setattr("labcal.run.worker.STARTS", 2)
    with open_pool(1) as pool, pytest.raises(DeviceError, match=r"2 ended before their first .*SIGKILL"):
        pool.submit(square, 1).result()


def test_an_error_that_cannot_be_pickled_reaches_the_caller() -> None:
    with open_pool(1) as pool:
        with pytest.raises(UnknownNameError, match="Did you mean 'brown5'"):
            pool.submit(unknown_name).result()
        with pytest.raises(RuntimeError, match="StubbornError: cannot be unpickled"):
            pool.submit(stubborn).result()


def test_an_interrupt_does_not_wait_for_what_is_begun() -> None:
    futures: list[Future[None]] = []

    def interrupted() -> None:
        with open_executor(2) as pool:
            futures.extend(pool.submit(time.sleep, 60) for _ in range(4))
            time.sleep(1.0)
            raise KeyboardInterrupt

    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert time.monotonic() - began < 20
    assert all(future.done() for future in futures)
    assert active_children() == []


def test_no_process_is_left_when_all_is_done() -> None:
    threads = threading.active_count()
    with open_executor(2) as pool:
        assert list(pool.map(square, range(5))) == [0, 1, 4, 9, 16]
    assert active_children() == []
    deadline = time.monotonic() + 5
    while threading.active_count() > threads and time.monotonic() < deadline:
        time.sleep(0.01)
    assert threading.active_count() == threads
