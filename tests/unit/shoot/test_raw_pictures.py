"""Pictures without a header, and Bayer mosaics, packed here by the words of the standards."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.correspond.picture_set import open_pictures
from labcal.errors import InputError
from labcal.shoot.raw_pictures import RawFormat, developed, parse_raw_format, read_raw_picture

VALUES = np.random.default_rng(4).integers(0, 4096, (6, 10))


def packed_p(values: np.ndarray, bits: int) -> bytes:
    """Return values without gaps, the lower bits first (PFNC, ``p``)."""
    number = sum(int(value) << bits * place for place, value in enumerate(values.ravel()))
    return number.to_bytes((bits * values.size + 7) // 8, "little")


def packed_gige(values: np.ndarray, bits: int) -> bytes:
    """Return two values in three bytes: their upper 8 bits outside, the lower bits of both between."""
    low, data = bits - 8, bytearray()
    for first, second in values.reshape(-1, 2).tolist():
        mask = (1 << low) - 1
        data += bytes([first >> low, (first & mask) | (second & mask) << 4, second >> low])
    return bytes(data)


@pytest.mark.parametrize(
    ("form", "values", "data"),
    [
        ("Mono12p", VALUES, packed_p(VALUES, 12)),
        ("Mono10p", VALUES % 1024, packed_p(VALUES % 1024, 10)),
        ("Mono12Packed", VALUES, packed_gige(VALUES, 12)),
        ("Mono10Packed", VALUES % 1024, packed_gige(VALUES % 1024, 10)),
        ("Mono12", VALUES, VALUES.astype("<u2").tobytes()),
        ("Mono8", VALUES % 256, (VALUES % 256).astype(np.uint8).tobytes()),
    ],
)
def test_pixels_without_a_header_keep_their_values(
    tmp_path: Path, form: str, values: np.ndarray, data: bytes
) -> None:
    (tmp_path / "a.raw").write_bytes(data)
    np.testing.assert_array_equal(read_raw_picture(tmp_path / "a.raw", parse_raw_format(f"{form}:10x6")), values)
    with pytest.raises(InputError, match="State it with the pixel format"):
        read_raw_picture(tmp_path / "a.raw", parse_raw_format(form))
    (tmp_path / "a.raw").write_bytes(data + b"12")
    with pytest.raises(InputError, match=rf"has {len(data) + 2} bytes, but 10 x 6 pixels .* take {len(data)}"):
        read_raw_picture(tmp_path / "a.raw", parse_raw_format(f"{form}:10x6"))


@pytest.mark.parametrize(
    ("pattern", "corners"), [("RG", "RGGB"), ("GR", "GRBG"), ("GB", "GBRG"), ("BG", "BGGR")]
)
def test_a_mosaic_gives_the_colours_of_its_pattern_balanced(pattern: str, corners: str) -> None:
    mosaic = np.zeros((20, 30), dtype=np.uint16)
    light = {"R": 900, "G": 2000, "B": 500}
    rows = np.repeat([1.0, 0.5], 10)[:, None]
    for place, colour in enumerate(corners):
        i, j = divmod(place, 2)
        mosaic[i::2, j::2] = (light[colour] * rows[i::2]).astype(np.uint16)
    colours = developed(mosaic, pattern).astype(float)
    assert np.ptp(colours[2:8, 2:-2]) <= 2  # grey light is grey
    np.testing.assert_allclose(colours[14, 14] / colours[5, 5], 0.5, atol=0.01)


def test_a_red_light_is_red_by_the_right_pattern_alone() -> None:
    mosaic = np.full((40, 40), 100, dtype=np.uint8)
    mosaic[0:20:2, 0:20:2] = 200  # red pixels of RGGB, over a quarter of the picture
    red = developed(mosaic, "RG")[4:16, 4:16].mean(axis=(0, 1))
    assert red[0] > 1.3 * red[1]
    assert red[0] > 1.3 * red[2]
    blue = developed(mosaic, "BG")[4:16, 4:16].mean(axis=(0, 1))
    assert blue[2] > 1.3 * blue[0]


@pytest.mark.parametrize("text", ["", "Bayer8", "BayerRG", "mono8", "Mono12p:10", "BayerRG8:0x4", "Mono9", "RGB8"])
def test_what_is_no_pixel_format_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="`raw`"):
        parse_raw_format(text)


def test_folders_of_raw_files_are_read_with_their_format(tmp_path: Path) -> None:
    for name in ("a_0.raw", "a_1.raw"):
        (tmp_path / name).write_bytes(packed_p(VALUES, 12))
    found = open_pictures(tmp_path, "_0=left,_1=right", raw="BayerRG12p:10x6")
    assert [(one.view, one.camera) for one in found.sources] == [("a", "left"), ("a", "right")]
    assert found.sources[0].raw == RawFormat("RG", 12, "p", (10, 6))
    assert found.sources[0].read().shape == (6, 10, 3)
    cv2.imwrite(str(tmp_path / "b.png"), np.zeros((6, 10, 3), dtype=np.uint8))
    with pytest.raises(InputError, match="holds no mosaic"):
        open_pictures(tmp_path / "b.png", raw="BayerGB8").sources[0].read()
