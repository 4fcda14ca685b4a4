"""Drawn pictures of a simulated shoot, as files that the detector measures."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from labcal.bench.diagnose.held_shoot import HeldShoot, Picture
from labcal.correspond.measure import Measurement, measure_pictures
from labcal.correspond.sources import Source
from labcal.guide.rehearsal.drawn_view import drawn_view
from labcal.render.sensor_response import Shot
from labcal.run.executor import SerialExecutor
from labcal.run.progress import NoProgress
from labcal.scene.photometry import Photometry


@dataclass(frozen=True)
class Fault:
    """A fault of some pictures of a camera.

    Attributes
    ----------
    camera : str
    views : frozenset of str
    blur_px : float
        Standard deviation of a defocus, on top of the lens's own point spread.
    motion_px : float
        Length of a blur of motion.
    stops : float
        Over-exposure.
    scale : float
        Of the stored picture.
    """

    camera: str = ""
    views: frozenset[str] = frozenset()
    blur_px: float = 0.0
    motion_px: float = 0.0
    stops: float = 0.0
    scale: float = 1.0

    def of(self, picture: Picture) -> "Fault":
        """Return what is wrong with a picture."""
        return self if picture.camera == self.camera and picture.view in self.views else Fault()


def drawn_shoot(
    shoot: HeldShoot, fault: Fault, folder: Path, random: np.random.Generator
) -> list[Measurement]:
    """Draw all pictures into a folder, and return what the detector measures in them.

    Parameters
    ----------
    shoot : HeldShoot
    fault : Fault
    folder : Path
        That exists.
    random : numpy.random.Generator
    """
    seed, angle = int(random.integers(2**31)), float(random.uniform(0.0, np.pi))
    usual = float(random.uniform(0.6, 0.9)), float(random.uniform(-0.4, 0.1))
    sources = []
    for picture in shoot.pictures:
        drawn = _drawn(shoot, picture, fault.of(picture), (seed, angle), usual)
        path = folder / f"{picture.view}_{picture.camera}.png"
        cv2.imwrite(str(path), drawn)
        sources.append(Source(picture.view, picture.camera, str(path), None))
    with SerialExecutor() as executor:
        return measure_pictures(sources, shoot.described, executor, NoProgress())


def _drawn(
    shoot: HeldShoot, picture: Picture, fault: Fault, chance: tuple[int, float], usual: tuple[float, float]
) -> np.ndarray:
    (seed, angle), (blur_px, stops) = chance, usual
    photometry = Photometry(
        blur_px=float(np.hypot(blur_px, fault.blur_px)), exposure_stops=stops + fault.stops, format="png"
    )
    shot = Shot(seed, picture.view, picture.camera)
    drawn = drawn_view(picture.device, picture.T_world_target, shoot.printed, photometry, shot)
    part = drawn.picture
    if fault.motion_px:
        part = cv2.filter2D(part, -1, _streak(fault.motion_px, angle), borderType=cv2.BORDER_REPLICATE)
    width, height = picture.device.size
    whole = np.full((height, width), np.median(part[:2]), dtype=part.dtype)
    x, y = drawn.corner.tolist()
    part = part[: height - y, : width - x]
    whole[y : y + part.shape[0], x : x + part.shape[1]] = part
    if fault.scale != 1.0:
        size = (round(fault.scale * width), round(fault.scale * height))
        whole = cv2.resize(whole, size, interpolation=cv2.INTER_AREA)
    return whole


def _streak(length_px: float, angle: float) -> np.ndarray:
    """Return the kernel of a blur along a line, of odd size."""
    half = int(np.ceil(0.5 * length_px)) + 1
    kernel = np.zeros((2 * half + 1, 2 * half + 1), dtype=np.float64)
    for along in np.linspace(-0.5 * length_px, 0.5 * length_px, 64):
        x, y = half + along * np.cos(angle), half + along * np.sin(angle)
        left, top = int(x), int(y)
        for row, col in ((top, left), (top, left + 1), (top + 1, left), (top + 1, left + 1)):
            kernel[row, col] += max(0.0, 1.0 - abs(x - col)) * max(0.0, 1.0 - abs(y - row))
    return np.asarray(kernel / kernel.sum())
