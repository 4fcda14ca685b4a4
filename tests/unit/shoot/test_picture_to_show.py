"""Pictures to look at, without a header."""

from pathlib import Path

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.shoot.picture_to_show import read_picture_to_show

GREY = np.arange(12, dtype=np.uint8).reshape(3, 4)


def test_bytes_and_pairs_of_bytes_are_greys(tmp_path: Path) -> None:
    path = tmp_path / "a.RAW"
    path.write_bytes(GREY.tobytes())
    np.testing.assert_array_equal(read_picture_to_show(path, (4, 3)), GREY)
    path.write_bytes((GREY.astype("<u2") * 100).tobytes())
    shown = read_picture_to_show(path, (4, 3))
    assert (shown.max(), shown.dtype) == (65535, np.uint16)
    np.testing.assert_allclose(shown / 65535.0, GREY / 11.0, atol=1e-4)


@pytest.mark.parametrize("packing", ["p", "Packed"])
def test_pairs_of_12_bits_in_three_bytes_are_shown(packing: str, tmp_path: Path) -> None:
    path, x = tmp_path / "a.raw", np.arange(64)
    picture = np.round(2000 + 1500 * np.sin(x / 9)[None, :] * np.cos(x / 7)[:, None]).astype(np.uint16)
    one, two = picture[:, 0::2], picture[:, 1::2]
    if packing == "p":
        three = [one & 255, one >> 8 | (two & 15) << 4, two >> 4]
    else:
        three = [one >> 4, one & 15 | (two & 15) << 4, two >> 4]
    path.write_bytes(np.stack(three, axis=-1).astype(np.uint8).tobytes())
    np.testing.assert_array_equal(read_picture_to_show(path, (64, 64)), picture >> 4)


def test_other_packed_pixels_are_not_guessed(tmp_path: Path) -> None:
    path = tmp_path / "a.raw"
    path.write_bytes(bytes(15))
    with pytest.raises(InputError, match="15 bytes are no 4 x 3 pixels"):
        read_picture_to_show(path, (4, 3))
    with pytest.raises(InputError):
        read_picture_to_show(path, None)
