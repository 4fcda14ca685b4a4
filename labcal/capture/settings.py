"""Settings of a capture: those of the sources, and those of the pictures that enter the shoot."""

from dataclasses import dataclass

from labcal.arguments import set_checked, whole_number
from labcal.capture.guide_settings import GuideSettings
from labcal.errors import InputError
from labcal.paths import AnyPath
from labcal.targets.print_scale import AnyPrintScale, print_scale


@dataclass(frozen=True)
class SourceSettings:
    """Settings that sources take as far as they apply to them.

    Examples
    --------
    >>> from labcal.pipeline import SourceSettings
    >>> SourceSettings(cameras="_0=left,_1=right").timeout_s
    5.0
    """

    exposure_us: float | None = None
    """Exposure time to set and lock, microseconds; as the device has it where left out."""
    gain: float | None = None
    """Gain to set and lock, in the device's unit; as the device has it where left out."""
    timeout_s: float = 5.0
    """Longest wait for a picture of a live camera, or of :data:`watch` for the next file, s."""
    cameras: str | None = None
    """Names of cameras by the end of file names or by patterns, of `folder` and `watch`."""
    raw: str | None = None
    """Pixel format of pictures that hold a mosaic or have no header, of `folder` and `watch`, as of
    :func:`labcal.pipeline.open_pictures`; the shoot then gets the pictures as they are measured."""
    seed: int = 0
    """Of noise and poses of `sim`."""
    overrides: tuple[str, ...] = ()
    """Values of the scene of `sim` to change, as in ``"spp=16"``."""
    every: int | None = None
    """Of videos: take one frame in so many; the sharpest of each second where left out."""
    video_offset: float | None = None
    """Of two videos: how many frames of the second one a moment comes later in it; where left out, it is
    estimated from the motion of the target."""


@dataclass(frozen=True)
class CaptureSettings:
    """Settings of a capture.

    Examples
    --------
    >>> from labcal.pipeline import CaptureSettings, SourceSettings
    >>> ten = CaptureSettings(views=10, source_settings=SourceSettings(exposure_us=5000.0))
    >>> ten.views, ten.max_skew_ms
    (10, 50.0)
    """

    views: int | None = None
    """Number of views; of recordings, all that they hold where left out."""
    interval_s: float = 1.0
    """Time from one set of pictures to the next, of live cameras, s."""
    max_skew_ms: float = 50.0
    """Longest time between the pictures of a set, ms; others are refused."""
    stage: AnyPath | None = None
    """``poses.csv``: readings of a stage, one line a view; none for a target in the hand."""
    source_settings: SourceSettings = SourceSettings()
    """Exposure, gain and other settings of the sources."""
    tries: int = 5
    """Sets that may be refused in a row before the capture ends with an error."""
    print_scale: AnyPrintScale | None = None
    """Measured over nominal length of the print's ruler, ``"99.8/100"``, which the shoot then states; for x
    and y apart ``"99.8/100,100.1/100"``."""
    force: bool = False
    """Replace a shoot that is there already."""
    guide: GuideSettings | None = None
    """Settings of a guided capture: after each view the error reached and the pose to take next; a plain
    capture where left out."""

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type or too small.
        """
        if self.print_scale is not None:
            set_checked(self, {"print_scale": print_scale(self.print_scale)})
        views = None if self.views is None else whole_number(self.views, "views", 1)
        set_checked(self, {"views": views, "tries": whole_number(self.tries, "tries", 1)})
        if not (self.interval_s >= 0.0 and self.max_skew_ms > 0.0):
            raise InputError(
                "`interval_s` must be 0 or more and `max_skew_ms` more than 0, but "
                f"{self.interval_s} and {self.max_skew_ms} were given."
            )
