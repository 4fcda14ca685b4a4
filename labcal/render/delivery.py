"""The conversion of the light of one picture into its file, in the format of the scene."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.render.development import develop
from labcal.render.sensor_response import Exposure, Shot, expose, read_sensor
from labcal.scene.photometry import Photometry, PictureFormat, Stage
from labcal.shoot.exr import write_exr
from labcal.shoot.pictures import write_picture


@dataclass(frozen=True)
class Destination:
    """The destination of a picture, and the texts in its header."""

    path: Path
    texts: Mapping[str, str]
    """By name; only the header of an EXR file holds them."""


def deliver(
    light: np.ndarray,
    photometry: Photometry,
    exposure: Exposure,
    shot: Shot | None,
    destination: Destination,
) -> None:
    """Expose a sensor, read and develop it as the description asks, and write the picture.

    Parameters
    ----------
    light : ndarray of float32, shape (height, width), or (height, width, 3) for a Bayer mosaic
        Radiance that each pixel gathers, behind the point spread of the lens.
    photometry : Photometry
        The format EXR holds the light as a share of the saturation, without any noise.
    exposure : Exposure
    shot : Shot or None
        What the noise is drawn for; none: no noise and no patterns.
    destination : Destination

    Raises
    ------
    OutputError
        The file exists already, or cannot be written.
    """
    if photometry.format is PictureFormat.EXR:
        write_exr(destination.path, expose(light, exposure), destination.texts)
        return
    picture = sensor_picture(light, photometry, exposure, shot)
    write_picture(destination.path, picture, jpeg_quality=photometry.jpeg_quality)


def sensor_picture(
    light: np.ndarray, photometry: Photometry, exposure: Exposure, shot: Shot | None
) -> np.ndarray:
    """Return the picture that a camera makes of light, before it is put into a file.

    Parameters
    ----------
    light, photometry, exposure, shot
        As of :func:`deliver`.

    Returns
    -------
    ndarray, shape (height, width) or (height, width, 3)
        uint8 or uint16.
    """
    picture = read_sensor(light, photometry, exposure, shot)
    return develop(picture, photometry, exposure) if photometry.stage is Stage.PICTURE else picture
