"""The brightness of lossy pictures in colour."""

import cv2
import numpy as np

from labcal.shoot.luma import stored_luma
from labcal.shoot.pictures import red_first


def test_luma_of_a_jpeg_picture_is_the_one_that_is_stored() -> None:
    # Colours are stored at half the resolution: fringes of them are no part of the luma.
    random = np.random.default_rng(1)
    grey = cv2.GaussianBlur(random.integers(0, 255, (64, 80)).astype(np.uint8), (0, 0), 1.5)
    colour = np.clip(grey[..., None] + random.integers(-30, 30, (64, 80, 3)), 40, 215).astype(np.uint8)
    data = cv2.imencode(".jpg", colour, [cv2.IMWRITE_JPEG_QUALITY, 95])[1]
    stored = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE).astype(int)
    read = red_first(cv2.imdecode(data, cv2.IMREAD_UNCHANGED))
    found = stored_luma("a/PICTURE.JPG", read)
    assert found.dtype == np.uint8
    assert np.abs(found - stored).max() <= 1
    mean = (read[..., 0].astype(int) + 2 * read[..., 1] + read[..., 2]) // 4
    assert np.abs(mean - stored).max() > 3


def test_other_pictures_stay_as_they_are() -> None:
    colour, grey = np.zeros((4, 5, 3), dtype=np.uint16), np.zeros((4, 5), dtype=np.uint8)
    assert stored_luma("a.png", colour) is colour
    assert stored_luma("a.jpg", grey) is grey
