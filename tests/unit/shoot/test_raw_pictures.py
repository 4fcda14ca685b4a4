"""Pictures without a header, and Bayer mosaics, packed here by the words of the standards."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.correspond.picture_set import open_pictures
from labcal.detect.detector import detect_dots
from labcal.errors import InputError
from labcal.shoot.raw_pictures import RawFormat, balanced_mosaic, parse_raw_format, read_raw_picture
from labcal.targets.grid import DotGrid

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
    np.testing.assert_array_equal(
        read_raw_picture(tmp_path / "a.raw", parse_raw_format(f"{form}:10x6")), values
    )
    with pytest.raises(InputError, match="State it with the pixel format"):
        read_raw_picture(tmp_path / "a.raw", parse_raw_format(form))
    (tmp_path / "a.raw").write_bytes(data + b"12")
    with pytest.raises(
        InputError, match=rf"has {len(data) + 2} bytes, but 10 x 6 pixels .* take {len(data)}"
    ):
        read_raw_picture(tmp_path / "a.raw", parse_raw_format(f"{form}:10x6"))


@pytest.mark.parametrize(
    ("pattern", "corners"), [("RG", "RGGB"), ("GR", "GRBG"), ("GB", "GBRG"), ("BG", "BGGR")]
)
def test_a_mosaic_of_grey_things_in_coloured_light_becomes_grey(pattern: str, corners: str) -> None:
    mosaic = np.zeros((20, 30), dtype=np.uint16)
    light = {"R": 900, "G": 2000, "B": 500}
    rows = np.repeat([1.0, 0.5], 10)[:, None]
    for place, colour in enumerate(corners):
        i, j = divmod(place, 2)
        mosaic[i::2, j::2] = (light[colour] * rows[i::2]).astype(np.uint16)
    grey = balanced_mosaic(mosaic, pattern)
    assert grey.dtype == np.uint16
    assert np.abs(grey[:10].astype(int) - 2000).max() <= 1
    assert np.abs(grey[10:].astype(int) - 1000).max() <= 1
    # By another pattern it stays a mosaic.
    other = {"RG": "GR", "GR": "RG", "GB": "BG", "BG": "GB"}[pattern]
    assert np.ptp(balanced_mosaic(mosaic, other)[:10].astype(int)) > 300


def test_dots_behind_a_mosaic_are_measured_better_by_its_pattern() -> None:
    """In light of another colour the pixels of red and blue are darker by half: stripes on board and dots."""
    target = DotGrid(
        name="plain",
        cols=7,
        rows=5,
        pitch_x_mm=20,
        pitch_y_mm=20,
        dot_diameter_mm=10,
        rings=None,
        margin_mm=20,
    )
    places = target.points(target.indices())[:, :2] * [2.6, -2.6] + [60.3, 260.7]
    canvas = np.full((320 * 8, 440 * 8), 210, dtype=np.uint8)
    for x, y in np.round(((places + 0.5) * 8 - 0.5) * 16).astype(int):
        cv2.circle(canvas, (int(x), int(y)), 13 * 8 * 16, 40, -1, cv2.LINE_AA, 4)
    light = cv2.GaussianBlur(cv2.resize(canvas, (440, 320), interpolation=cv2.INTER_AREA), (0, 0), 0.8)
    mosaic = light.astype(np.float64)
    mosaic[0::2, 0::2] *= 0.55
    mosaic[1::2, 1::2] *= 0.45
    noise = np.random.default_rng(2).normal(0, 2.0, mosaic.shape)
    mosaic = np.clip(np.round(mosaic + noise), 0, 255).astype(np.uint8)
    rms = []
    for picture in (mosaic, balanced_mosaic(mosaic, "RG")):
        dots = detect_dots(picture, target)
        assert int(dots.ok.sum()) == 35
        rms.append(np.sqrt(((dots.position - places) ** 2).sum(axis=1).mean()))
    assert rms[1] < 0.8 * rms[0]


@pytest.mark.parametrize(
    "text", ["", "Bayer8", "BayerRG", "rggb8", "Mono12p:10", "BayerRG8:0x4", "Mono9", "RGB8"]
)
def test_what_is_no_pixel_format_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="`raw`"):
        parse_raw_format(text)


def test_folders_of_raw_files_are_read_with_their_format(tmp_path: Path) -> None:
    for name in ("a_0.raw", "a_1.raw"):
        (tmp_path / name).write_bytes(packed_p(VALUES, 12))
    found = open_pictures(tmp_path, "_0=left,_1=right", raw="BayerRG12p:10x6")
    assert [(one.view, one.camera) for one in found.sources] == [("a", "left"), ("a", "right")]
    assert found.sources[0].raw == RawFormat("RG", 12, "p", (10, 6))
    assert found.sources[0].read().shape == (6, 10)
    cv2.imwrite(str(tmp_path / "b.png"), np.zeros((6, 10, 3), dtype=np.uint8))
    with pytest.raises(InputError, match="holds no mosaic"):
        open_pictures(tmp_path / "b.png", raw="BayerGB8").sources[0].read()


def test_errors_of_dots_behind_a_mosaic_are_as_stated() -> None:
    """Photon and read noise, unlike gains of the colours: the pixels of red and blue are noisier."""
    target = DotGrid(
        name="plain", cols=7, rows=5, pitch_x_mm=20, pitch_y_mm=20, dot_diameter_mm=10, rings=None,
        margin_mm=20,
    )  # fmt: skip
    random = np.random.default_rng(2)
    rows, columns = np.mgrid[:320, :440]
    squares = []
    for _ in range(4):
        places = target.points(target.indices())[:, :2] * [2.6, -2.6] + [60.3, 260.7]
        places += random.uniform(-2.0, 2.0, 2)
        light = np.full((320, 440), 210.0)
        for x, y in places:  # symmetric about the place, whatever the form of the edge
            light -= 85.0 * (1.0 - np.tanh((np.hypot(columns - x, rows - y) - 13.0) / 0.9))
        light[0::2, 0::2] *= 0.55
        light[1::2, 1::2] *= 0.45
        light += random.standard_normal(light.shape) * np.sqrt(4.0 + 0.1 * light)
        mosaic = np.clip(np.round(light), 0, 255).astype(np.uint8)
        dots = detect_dots(balanced_mosaic(mosaic, "RG"), target)
        assert int(dots.ok.sum()) == 35
        distances = np.linalg.norm(dots.position[:, None] - places[None], axis=2)
        errors = dots.position - places[distances.argmin(axis=1)]
        squares.append(np.einsum("ni,nij,nj->n", errors, np.linalg.inv(dots.covariance), errors))
    degrees = 2 * sum(map(len, squares))
    assert abs(np.concatenate(squares).sum() - degrees) < 3.0 * np.sqrt(2.0 * degrees)


def test_a_burnt_colour_of_a_mosaic_stays_burnt() -> None:
    mosaic = np.random.default_rng(1).integers(90, 110, (40, 40)).astype(np.uint8)
    mosaic[0::2, 1::2] = mosaic[1::2, 0::2] = 255  # green
    mosaic[:20] //= 4
    balanced = balanced_mosaic(mosaic, "RG")
    assert np.count_nonzero(balanced == balanced.max()) >= 400  # all green pixels of the lower half


@pytest.mark.parametrize(
    ("text", "form"),
    [
        ("bayer_rggb8", RawFormat("RG", 8, "", None)),
        ("bayer_gbrg16", RawFormat("GB", 16, "", None)),
        ("bayergr12P:64X32", RawFormat("GR", 12, "p", (64, 32))),
        ("mono12packed:64x32", RawFormat(None, 12, "Packed", (64, 32))),
        ("mono16", RawFormat(None, 16, "", None)),
    ],
)
def test_names_of_ros_and_of_any_case_are_read(text: str, form: RawFormat) -> None:
    assert parse_raw_format(text) == form


def test_another_pattern_than_the_mosaics_is_refused(tmp_path: Path) -> None:
    light = np.random.default_rng(2).uniform(80.0, 200.0, (40, 60))
    gain = np.tile(np.array([[0.6, 1.0], [1.0, 0.45]]), (20, 30))
    cv2.imwrite(str(tmp_path / "a.png"), (light * gain).astype(np.uint8))
    for pattern in ("GR", "GB"):
        with pytest.raises(InputError, match=f"not Bayer{pattern}: .*BayerRG or BayerBG"):
            read_raw_picture(tmp_path / "a.png", parse_raw_format(f"Bayer{pattern}8"))
    read_raw_picture(tmp_path / "a.png", parse_raw_format("BayerRG8"))
    cv2.imwrite(str(tmp_path / "grey.png"), light.astype(np.uint8))
    read_raw_picture(tmp_path / "grey.png", parse_raw_format("BayerGR8"))  # in white light all are alike
