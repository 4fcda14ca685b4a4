"""Settings of a measurement of named points."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from labcal.arguments import any_number, one_text, set_checked
from labcal.bounds import LONGEST_SIDE_PX
from labcal.errors import InputError
from labcal.reconstruct.scale.scale_bar import ScaleBar
from labcal.wording import shown

_LEAST_SIGMA_PX = 1e-9
_MOST_PPM = 1e4


@dataclass(frozen=True)
class MeasureSettings:
    """Facts that named pixels do not state, and the frame that their points are wanted in.

    Examples
    --------
    >>> from labcal import examples
    >>> from labcal.pipeline import MeasureSettings, measure
    >>> settings = MeasureSettings(frame="points:origin,right-corner,upper-corner")
    >>> found = measure(examples.rig(), examples.pixels(), settings=settings)
    >>> found.points.point[:2].round(1)
    array([[  0.,   0.,   0.],
           [100.,   0.,   0.]])
    """

    pixel_sigma: float | None = None
    """Standard deviation of x and of y, px, of pixels that state no covariance; needed if there are such."""
    frame: str | None = None
    """Frame of the points: ``points:ORIGIN,ON-X,IN-PLANE`` (three names), ``board:detections.csv`` (of a
    target that lies in it), ``rigid:known.csv`` or ``similarity:known.csv`` (columns point, X_mm, Y_mm, Z_mm
    and, where known, sigma_mm); that of the model if left out."""
    frame_view: str | None = None
    """The view whose points or dots determine the frame, where several have them."""
    scale_bars: Sequence[ScaleBar | str] = ()
    """Known distances between named points: ``"ONE,OTHER,LENGTH,SIGMA"``, mm."""
    scale_sigma_ppm: float | None = None
    """Standard deviation of the rig's scale before the bars, ppm: how far off the pitch of its target may be.
    Nothing is known of it if left out, and the bars alone give the scale."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, or no standard deviation.
        """
        values: dict[str, object] = {}
        for name in ("frame", "frame_view"):
            given = getattr(self, name)
            values[name] = None if given is None else one_text(given, name)
        if self.pixel_sigma is not None:
            values["pixel_sigma"] = _sigma(self.pixel_sigma)
        if self.frame_view is not None and self.frame is None:
            raise InputError("`frame_view` goes with a frame. Give `frame`, too, or leave it out.")
        bars = [self.scale_bars] if isinstance(self.scale_bars, str | ScaleBar) else self.scale_bars
        values["scale_bars"] = tuple(ScaleBar.of(bar) for bar in bars)
        if values["scale_bars"] and self.frame is not None and self.frame.startswith("board:"):
            raise InputError(
                "`scale_bars` correct the cameras for the points that they are measured with, and a board's "
                "dots were measured without them: the frame would have another scale than the points. Leave "
                "one of them out, or name a frame by points of the same table (points:, rigid:, similarity:)."
            )
        if self.scale_sigma_ppm is not None:
            values["scale_sigma_ppm"] = _ppm(self.scale_sigma_ppm)
            if not values["scale_bars"]:
                raise InputError(
                    "`scale_sigma_ppm` goes with scale bars. Give `scale_bars`, too, or leave it out."
                )
        set_checked(self, values)


def _sigma(given: object) -> float:
    """Return a standard deviation, px."""
    sigma = any_number(given, "pixel_sigma", "a number of px")
    if not (isfinite(sigma) and _LEAST_SIGMA_PX <= sigma <= LONGEST_SIDE_PX):
        raise InputError(
            f"`pixel_sigma` is the standard deviation of a pixel's x and y, a positive number of px, but "
            f"{shown(given)} was given."
        )
    return sigma


def _ppm(given: object) -> float:
    """Return the standard deviation of a scale, ppm."""
    sigma = any_number(given, "scale_sigma_ppm", "a number of ppm")
    if not (isfinite(sigma) and 0.0 <= sigma <= _MOST_PPM):
        raise InputError(
            f"`scale_sigma_ppm` is a standard deviation from 0 to {_MOST_PPM:g} ppm, but {shown(given)} was "
            "given."
        )
    return sigma
