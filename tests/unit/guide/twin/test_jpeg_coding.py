"""Compression as a photograph had it gives the photograph again, and no other picture."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.guide.twin.jpeg_coding import JpegCoding
from labcal.guide.twin.stored import StoredValues
from labcal.shoot.pictures import read_picture
from labcal.shoot.tone_curve import ToneCurve

EVERY, HALF = cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420


def _picture(*shape: int) -> np.ndarray:
    random = np.random.default_rng(4)
    soft = cv2.GaussianBlur(random.uniform(0.0, 255.0, shape), (0, 0), 1.5)
    return np.clip(4.0 * (soft - 127.5) + 127.5, 0.0, 255.0).astype(np.uint8)


@pytest.mark.parametrize("quality", [60, 90, 97])
@pytest.mark.parametrize(
    ("shape", "sampling"), [((50, 61), EVERY), ((50, 61, 3), EVERY), ((50, 61, 3), HALF)]
)
def test_a_picture_is_coded_as_the_file_was(
    tmp_path: Path, quality: int, shape: tuple[int, ...], sampling: int
) -> None:
    path, picture = tmp_path / "a.jpg", _picture(*shape)
    how = [cv2.IMWRITE_JPEG_QUALITY, quality, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, sampling]
    cv2.imwrite(str(path), picture[..., ::-1] if picture.ndim == 3 else picture, how)
    coding = JpegCoding.of(path)
    assert coding is not None
    np.testing.assert_array_equal(coding.coded(picture), read_picture(path))


def test_pictures_without_loss_and_foreign_files_have_none(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), _picture(20, 20))
    (tmp_path / "b.jpg").write_bytes(b"no picture")
    assert JpegCoding.of(tmp_path / "a.png") is None
    assert JpegCoding.of(tmp_path / "b.jpg") is None


def test_stored_values_are_compressed_only_in_their_own_form(tmp_path: Path) -> None:
    path, picture = tmp_path / "a.jpg", _picture(48, 48)
    cv2.imwrite(str(path), picture, [cv2.IMWRITE_JPEG_QUALITY, 70])
    coding = JpegCoding.of(path)
    stored = StoredValues.of(picture, ToneCurve.LINEAR, coding)
    np.testing.assert_array_equal(stored.picture([picture.astype(np.float32)]), read_picture(path))
    assert StoredValues.of(picture.astype(np.uint16), ToneCurve.LINEAR, coding).coding is None
    assert StoredValues.of(np.stack([picture] * 3, axis=-1), ToneCurve.LINEAR, coding).coding is None


@pytest.mark.parametrize("sampling", [HALF, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_422])
@pytest.mark.parametrize("size", [(50, 61), (48, 64)])
def test_colours_are_sampled_as_in_files_of_the_finest_steps(
    tmp_path: Path, sampling: int, size: tuple[int, int]
) -> None:
    path, picture = tmp_path / "a.jpg", np.clip(_picture(*size, 3), 60, 190)
    how = [cv2.IMWRITE_JPEG_QUALITY, 100, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, sampling]
    cv2.imwrite(str(path), picture[..., ::-1], how)
    coding = JpegCoding.of(path)
    assert coding is not None
    wanted, found = read_picture(path).astype(np.float32), coding.sampled(picture.astype(np.float32))
    assert np.sqrt(((found - wanted) ** 2).mean()) < 1.0  # rounding; 10 and more without sampling
    assert np.abs(found - wanted).max() < 4.0


@pytest.mark.parametrize("curve", [ToneCurve.LINEAR, ToneCurve.SRGB])
def test_grey_light_stays_what_it_is_where_colours_are_sampled(tmp_path: Path, curve: ToneCurve) -> None:
    path, picture = (
        tmp_path / "a.jpg",
        np.tile(np.arange(10, 250, 5, dtype=np.uint8)[:, None, None], (1, 32, 3)),
    )
    cv2.imwrite(str(path), picture, [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, HALF])
    stored = StoredValues.of(picture, curve, JpegCoding.of(path))
    channels = stored.channels(picture)
    for before, after in zip(channels, stored.sampled(channels), strict=True):
        np.testing.assert_allclose(after, before, atol=0.05)
