"""Pictures of flat prints as a camera without distortion sees them, drawn by a homography."""

import cv2
import numpy as np


def photograph(
    sheet: np.ndarray, size: tuple[int, int], fill: float, tilt_deg: float, axis_deg: float
) -> np.ndarray:
    """Return a picture of a sheet that is turned about an axis in its plane, with blur and noise.

    Parameters
    ----------
    sheet : ndarray of uint8, shape (h, w)
        The print.
    size : tuple of int
        Width and height of the picture, px.
    fill : float
        Width of the sheet, seen squarely, over that of the picture.
    tilt_deg, axis_deg : float
        Angle, and direction of the axis, 0 along the rows.

    Returns
    -------
    ndarray of uint8
        Blurred by 0.8 px, with noise of 1 % of the range, white paper at 0.86 of it.
    """
    width, height = size
    high, wide = sheet.shape
    focal, over = 1.2 * width, 3
    axis = np.radians(axis_deg)
    turn, _ = cv2.Rodrigues(np.radians(tilt_deg) * np.array([np.cos(axis), np.sin(axis), 0.0]))
    K = np.array([[focal, 0.0, 0.5 * width], [0.0, focal, 0.5 * height], [0.0, 0.0, 1.0]])
    distance = focal * wide / (fill * width)
    to_camera = np.column_stack(
        [turn[:, 0], turn[:, 1], [0.0, 0.0, distance] - turn[:, :2] @ [wide / 2, high / 2]]
    )
    pixels_per_pixel = wide / (fill * width)
    soft = cv2.GaussianBlur(sheet, (0, 0), max(0.1, 0.4 * pixels_per_pixel / over))
    finer = np.diag([over, over, 1.0]) @ K @ to_camera
    seen = cv2.warpPerspective(
        soft, finer, (over * width, over * height), flags=cv2.INTER_LINEAR, borderValue=128
    )
    seen = cv2.resize(seen, size, interpolation=cv2.INTER_AREA).astype(np.float64)
    noise = np.random.default_rng(1).normal(0.0, 2.55, seen.shape)
    return np.clip(40.0 + 0.7 * cv2.GaussianBlur(seen, (0, 0), 0.8) + noise, 0, 255).astype(np.uint8)
