import cv2
import numpy as np

from labcal.render.demosaic import demosaic, mosaic


def test_demosaicing_is_exact_on_grey_ramps() -> None:
    # All three colours equal and linear in position: the filters are exact there, away from the border.
    y, x = np.mgrid[:24, :30].astype(np.float64)
    grey = 0.2 + 0.01 * x + 0.015 * y
    picture = demosaic(mosaic(np.stack([grey] * 3, axis=-1)))
    np.testing.assert_allclose(picture[2:-2, 2:-2], np.stack([grey] * 3, axis=-1)[2:-2, 2:-2], atol=1e-6)


def test_demosaicing_puts_each_colour_where_opencv_does() -> None:
    y, x = np.mgrid[:40, :40]
    smooth = np.stack([20000 + 8000 * np.sin((x + 2 * y + k) / 9 + k) for k in range(3)], axis=-1)
    ours = demosaic(mosaic(smooth))
    # OpenCV names the pattern by the second row's second and third pixels.
    theirs = cv2.demosaicing(mosaic(smooth).astype(np.uint16), cv2.COLOR_BayerBG2RGB)
    inside = (slice(3, -3), slice(3, -3))
    assert np.abs(ours[inside] - smooth[inside]).max() < 600
    assert np.abs(theirs[inside] - smooth[inside]).max() < 400


def test_a_mosaic_starts_with_red_green() -> None:
    behind = mosaic(np.broadcast_to(np.array([1.0, 2.0, 3.0]), (4, 4, 3)))
    np.testing.assert_array_equal(behind[:2, :2], [[1.0, 2.0], [2.0, 3.0]])
