import pytest

from labcal.errors import DeviceError, WorkerError
from labcal.run.failed_cases import raise_failed_cases


def test_nothing_given_up_is_nothing_to_tell() -> None:
    raise_failed_cases({}, 3, "pictures", "Free memory.")


def test_a_few_are_named_and_told_how_they_ended() -> None:
    given_up = {f"v{n}.png": WorkerError("crashed with SIGSEGV") for n in range(9)}
    with pytest.raises(DeviceError) as caught:
        raise_failed_cases(given_up, 40, "pictures", "Free memory.")
    message = str(caught.value)
    assert message.startswith("9 of 40 pictures cannot be done: v0.png (crashed with SIGSEGV), v1.png")
    assert "v4.png (crashed with SIGSEGV), 4 more. Each" in message
    assert "v5.png" not in message
    assert "Free memory. Finished results are kept" in message
