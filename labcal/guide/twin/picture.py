"""One picture of a twin, compared with its photograph: pixels, and dots measured by the same detector."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.detect.dots import PictureDots
from labcal.guide.twin.again import TwinJob, rendered_again, rendered_share
from labcal.guide.twin.compression import with_compression
from labcal.guide.twin.dot_windows import DotWindows
from labcal.guide.twin.noise import PictureNoise
from labcal.guide.twin.pixel_figures import PixelFigures, difference_picture
from labcal.rng import generator
from labcal.shoot.pictures import write_picture
from labcal.targets.grid import DotGrid

SHOOT, RENDERING, DIFFERENCE = "shoot", "pictures/rendering", "pictures/difference"
"""Folders of the twin's own shoot, of renderings without noise, and of differences."""


@dataclass(frozen=True)
class TwinPicture:
    """Outcome of one picture.

    Attributes
    ----------
    view, camera, image : str
    size : (int, int)
    dots : int array, (n,)
        Numbers of dots.
    rendered : float64 array, (n, 2)
        Positions of these dots as measured in the rendering without noise, px; NaN where not measured.
    drawn : float64 array, (draws, n, 2)
        The same in renderings with noise.
    covariance : float64 array, (n, 2, 2)
        As the detector states it, of the first rendering with noise.
    blur_px : float
    windows : DotWindows
    pixels : PixelFigures
    noise : PictureNoise
        Of the main channel.
    curve : str
    is_compressed : bool
        True if compression with loss is simulated.
    """

    view: str
    camera: str
    image: str
    size: tuple[int, int]
    dots: Int64[np.ndarray, " n"]
    rendered: Float64[np.ndarray, "n 2"]
    drawn: Float64[np.ndarray, "draws n 2"]
    covariance: Float64[np.ndarray, "n 2 2"]
    blur_px: float
    windows: DotWindows
    pixels: PixelFigures
    noise: PictureNoise
    curve: str
    is_compressed: bool


def twin_picture(job: TwinJob) -> TwinPicture:
    """Render a picture again, compare pixels, and measure dots in the rendering as in the photograph.

    Raises
    ------
    InputError, OutputError, DeviceError
        As of :func:`rendered_again`, and of writing pictures.
    """
    from labcal.detect.detector import detect_dots  # noqa: PLC0415 -- imports Numba

    made = with_compression(rendered_again(job, rendered_share(job)), job)
    target = job.known.target
    dots, clean = job.dots, made.clean()
    values = [made.stored.values(light) for light in clean]
    smooth = values[0] if len(values) == 1 else np.stack(values, axis=-1)
    rendered, _ = _measured(detect_dots(smooth, target), target, dots)
    drawn, covariance = [], np.full((len(dots), 2, 2), np.nan)
    for number in range(job.draws):
        random = generator(job.seed, job.source.view, job.source.camera, "twin noise", str(number))
        noisy = made.noisy(number, random)
        place, stated = _measured(detect_dots(noisy, target), target, dots)
        drawn.append(place)
        if number == 0:
            covariance = stated
            if job.folder is not None:
                write_picture(job.folder / SHOOT / "images" / job.name, noisy, force=True)
    if job.folder is not None:
        write_picture(job.folder / RENDERING / job.name, made.stored.picture(clean), force=True)
        write_picture(job.folder / DIFFERENCE / job.name, difference_picture(made), force=True)
    return TwinPicture(
        job.source.view, job.source.camera, job.source.image, job.camera.size, dots, rendered,
        np.stack(drawn), covariance, made.blur_px, made.windows, PixelFigures.of(made), made.noise[made.main],
        made.stored.curve.value, made.stored.coding is not None,
    )  # fmt: skip


def _measured(
    found: PictureDots, target: DotGrid, dots: Int64[np.ndarray, " n"]
) -> tuple[Float64[np.ndarray, "n 2"], Float64[np.ndarray, "n 2 2"]]:
    """Return positions and covariances of some dots of a picture; NaN where one is no measurement."""
    place, covariance = np.full((target.count, 2), np.nan), np.full((target.count, 2, 2), np.nan)
    ok = found.ok
    number = found.index[ok, 1] * target.cols + found.index[ok, 0]
    place[number], covariance[number] = found.position[ok], found.covariance[ok]
    return place[dots], covariance[dots]
