"""Pictures of a ChArUco board that faces the cameras, drawn as StereoComplex draws them.

A pixel takes the brightness of a drawing of the board at the place that its ray meets, interpolated between
the drawing's pixels; then come uneven light, blur and noise. With one ray a pixel, edges are off by some
tenths of a pixel, which belongs to the protocol.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64, UInt8

from labcal.cameras.camera import Camera
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_board

Bytes = UInt8[np.ndarray, "h w"]

_WHITE = 255.0
_DRAWN_PX = 80
"""Side of a square in the drawing."""


@dataclass(frozen=True)
class PictureSettings:
    """Settings of pictures.

    Attributes
    ----------
    blur_px : float
        Standard deviation of a normal point-spread function, px.
    noise : float
        Standard deviation, as a share of white.
    slope : (float, float)
        Relative rise of the light from the middle of the picture to its right and to its lower edge.
    backgrounds : (float, float)
        Least and greatest grey outside the board.
    """

    blur_px: float
    noise: float
    slope: tuple[float, float]
    backgrounds: tuple[float, float]


@dataclass(frozen=True)
class PixelRays:
    """The rays of all pixels of a camera that looks along z.

    Attributes
    ----------
    origin : float64 array, (3,)
        World, mm.
    slopes : float64 array, (h, w, 2)
        x and y over z.
    """

    origin: Float64[np.ndarray, "3"]
    slopes: Float64[np.ndarray, "h w 2"]

    @classmethod
    def of(cls, camera: Camera) -> "PixelRays":
        """Return the rays of a camera whose lens is central."""
        width, height = camera.size
        x, y = np.meshgrid(np.arange(float(width)), np.arange(float(height)))
        ray = camera.rays(np.stack([x.ravel(), y.ravel()], axis=1))
        slopes = ray.direction[:, :2] / ray.direction[:, 2:]
        return cls(ray.origin[0], slopes.reshape(height, width, 2))

    def on_plane(self, z_mm: float) -> Float64[np.ndarray, "h w 2"]:
        """Return where the rays meet a plane across z, world, mm."""
        place: np.ndarray = self.origin[:2] + (z_mm - self.origin[2]) * self.slopes
        return place


def board_picture(
    rays: PixelRays, board: CharucoBoard, z_mm: float, settings: PictureSettings, random: np.random.Generator
) -> Bytes:
    """Return a picture of a board that faces along -z, with its middle on the world's z axis.

    Parameters
    ----------
    rays : PixelRays
    board : CharucoBoard
    z_mm : float
        Of the board, in the world.
    settings : PictureSettings
    random : numpy.random.Generator
        Draws the background and the noise.
    """
    squares = np.array(board.squares)
    half = 0.5 * board.square_mm * squares
    place = rays.on_plane(z_mm)
    inside = (np.abs(place) <= half).all(axis=-1)
    drawing = opencv_board(board).generateImage(tuple(_DRAWN_PX * squares), marginSize=0, borderBits=1)
    at = ((place + half) / board.square_mm * _DRAWN_PX - 0.5).astype(np.float32)
    white = cv2.remap(drawing, at[..., 0], at[..., 1], cv2.INTER_LANCZOS4) / _WHITE
    grey = np.where(inside, white, random.uniform(*settings.backgrounds))
    height, width = grey.shape
    right, down = np.meshgrid(np.linspace(-1.0, 1.0, width), np.linspace(-1.0, 1.0, height))
    lit = _in_bytes(grey * (1.0 + settings.slope[0] * right + settings.slope[1] * down))
    blurred = cv2.GaussianBlur(lit, (0, 0), settings.blur_px, borderType=cv2.BORDER_REFLECT)
    return _in_bytes(blurred / _WHITE + settings.noise * random.standard_normal(grey.shape))


def _in_bytes(grey: Float64[np.ndarray, "h w"]) -> Bytes:
    return np.asarray(np.clip(grey, 0.0, 1.0) * _WHITE + 0.5).astype(np.uint8)
