import signal

import pytest

from labcal.run.process_exit import OUT_OF_MEMORY_STATUS, exit_in_words, may_be_external


@pytest.mark.parametrize(
    ("status", "words", "foreign"),
    [
        (None, "for an unknown reason", False),
        (0, "with exit status 0", False),
        (1, "with exit status 1", False),
        (-signal.SIGSEGV, "crashed with SIGSEGV", False),
        (-signal.SIGABRT, "crashed with SIGABRT", False),
        (-signal.SIGTERM, "ended by SIGTERM", True),
        (OUT_OF_MEMORY_STATUS, "out of memory", False),
        (-63, "ended by signal 63", False),
        (0xC0000005, "crashed with 0xc0000005", False),
    ],
)
def test_an_exit_status_is_told_in_words(status: int | None, words: str, foreign: bool) -> None:  # noqa: FBT001
    assert exit_in_words(status) == words
    assert may_be_external(status) == foreign


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal there")
def test_a_killed_process_points_to_the_memory() -> None:
    assert "memory" in exit_in_words(-signal.SIGKILL)
    assert may_be_external(-signal.SIGKILL)
