"""Conversion of estimated cameras to plain arrays and one text, and back."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict

from labcal.calibrate.resection.placed import PlacedCamera
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError
from labcal.estimators.gp_field.evidence import FieldScale
from labcal.estimators.gp_field.fitted_camera import Asked, FittedCamera, FittedField
from labcal.estimators.gp_field.kernel import FieldKernel
from labcal.estimators.gp_field.pixel_field import PixelField
from labcal.estimators.gp_field.places import Places
from labcal.estimators.gp_field.waves import ALL_ALIKE, Spread, waves_of
from labcal.run.json_reading import json_content

FIGURES = 10
"""Of a camera: its noise; of its field amplitude, across, along, wavenumber, noise, gain, and three of its
places."""


class _Text(BaseModel):
    """The content of the text."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    cameras: tuple[CameraRecord, ...]
    asked: tuple[Asked | None, ...]
    waves: tuple[Spread | None, ...] = ()
    """None of a file that was written before waves had directions."""


@dataclass(frozen=True)
class FittedArrays:
    """The result of :func:`to_arrays`; for cameras without a field the last two are 0.

    Attributes
    ----------
    text : str
        JSON: the lens formulas' records, and by camera where its field is asked, and the directions (radians)
        and shares of its waves; null where it has none.
    middle : float64 array, (3,)
    figures : float64 array, (cameras, FIGURES)
    covariance : float64 array, (cameras, free, free)
        Padded with zeros to the camera with most free parameters.
    inputs : float64 array, (cameras, n, 3)
    residuals : float64 array, (cameras, n, 2)
    """

    text: str
    middle: Float64[np.ndarray, "3"]
    figures: Float64[np.ndarray, "cameras figures"]
    covariance: Float64[np.ndarray, "cameras free free"]
    inputs: Float64[np.ndarray, "cameras n 3"]
    residuals: Float64[np.ndarray, "cameras n 2"]


def free_count(text: str) -> tuple[int, int]:
    """Return the number of cameras, and the most free parameters that one has, of a text of `FittedArrays`.

    Raises
    ------
    InputError
        The text is damaged.
    """
    records = _parsed(text).cameras
    placed = [record.sensible_camera(str(number)) for number, record in enumerate(records, start=1)]
    counts = [PlacedCamera(camera, np.zeros(3)).count for camera in placed]
    return len(counts), max(counts, default=0)


def to_arrays(cameras: Sequence[FittedCamera], n: int) -> FittedArrays:
    """Return fitted cameras, trained on n points, as plain arrays."""
    most = max(camera.placed.count for camera in cameras)
    figures, covariance = np.zeros((len(cameras), FIGURES)), np.zeros((len(cameras), most, most))
    inputs, residuals = np.zeros((len(cameras), n, 3)), np.zeros((len(cameras), n, 2))
    asked: list[str | None] = []
    waves: list[dict[str, Any] | None] = []
    for number, camera in enumerate(cameras):
        count = camera.placed.count
        covariance[number, :count, :count] = camera.covariance
        figures[number, 0] = camera.noise_px
        asked.append(None if camera.fitted is None else camera.fitted.asked.value)
        waves.append(None)
        if camera.fitted is None:
            continue
        scale, places = camera.fitted.field.scale, camera.fitted.places
        if scale.kernel.waves is not None and scale.kernel.waves.spread != ALL_ALIKE:
            waves[-1] = asdict(scale.kernel.waves.spread)
        figures[number, 1:] = [
            scale.amplitude_px, scale.kernel.across, scale.kernel.along, scale.kernel.wavenumber,
            scale.noise_px, scale.gain, places.width_px, places.farthest, places.span,
        ]  # fmt: skip
        inputs[number], residuals[number] = camera.fitted.field.x, camera.fitted.field.residual
    records = [CameraRecord.of(camera.camera).model_dump(mode="json") for camera in cameras]
    content = {"cameras": records, "asked": asked, "waves": waves}
    text = json.dumps(content, sort_keys=True, allow_nan=False)
    return FittedArrays(text, cameras[0].placed.middle, figures, covariance, inputs, residuals)


def from_arrays(arrays: FittedArrays, p: Float64[np.ndarray, "n 3"]) -> tuple[FittedCamera, ...]:
    """Return fitted cameras from plain arrays, and the points (mm) that they were trained on.

    Raises
    ------
    InputError
        The text is damaged, or does not fit the arrays.
    """
    parsed = _parsed(arrays.text)
    if not len(parsed.cameras) == len(parsed.asked) == len(arrays.figures):
        raise InputError("The model's cameras do not fit its arrays. Fit it again.")
    spreads = parsed.waves or (None,) * len(parsed.cameras)
    found = []
    for number, (record, how, spread) in enumerate(zip(parsed.cameras, parsed.asked, spreads, strict=True)):
        placed = PlacedCamera(record.camera(), arrays.middle)
        noise, *figures = arrays.figures[number].tolist()
        fitted = None
        if how is not None:
            amplitude, across, along, wavenumber, field_noise, gain, width, farthest, span = figures
            waves = waves_of(wavenumber, spread or ALL_ALIKE) if wavenumber > 0.0 else None
            scale = FieldScale(FieldKernel(across, along, waves), amplitude, field_noise, gain)
            field = PixelField(scale, arrays.inputs[number], arrays.residuals[number])
            fitted = FittedField(field, Places(width, farthest, span), how, p)
        own = slice(placed.count)
        found.append(FittedCamera(placed, arrays.covariance[number, own, own], noise, fitted))
    return tuple(found)


def _parsed(text: str) -> _Text:
    content = json_content(text, "The text of the model's cameras")
    try:
        return _Text.model_validate(content)
    except (ValueError, RecursionError) as error:
        raise InputError(f"The model's cameras cannot be read: {error}. Fit it again.") from error
