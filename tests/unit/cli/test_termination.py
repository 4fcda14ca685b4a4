import signal
import threading

import pytest

from labcal.cli.failure import explain
from labcal.cli.termination import orderly_termination


def terminated() -> None:
    with orderly_termination():
        signal.raise_signal(signal.SIGTERM)


def test_sigterm_unwinds_as_an_interrupt_does() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(KeyboardInterrupt) as caught:
        terminated()
    assert signal.getsignal(signal.SIGTERM) is before
    failure = explain(caught.value)
    assert (failure.kind, failure.status) == ("Terminated", 143)
    assert "resumes" in failure.message


def test_a_handler_of_the_caller_s_own_is_left_alone() -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda number, _frame: heard.append(number))
    try:
        terminated()
    finally:
        signal.signal(signal.SIGTERM, before)
    assert heard == [signal.SIGTERM]


def test_other_threads_set_no_handler() -> None:
    failures: list[BaseException] = []

    def enter() -> None:
        try:
            with orderly_termination():
                pass
        except BaseException as error:  # noqa: BLE001 -- a thread must hand it on
            failures.append(error)

    thread = threading.Thread(target=enter)
    thread.start()
    thread.join()
    assert failures == []
