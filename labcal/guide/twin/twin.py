"""The digital twin of a shoot: its figures, and what simulation explains of the residuals."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from labcal.cameras.rig import Rig
from labcal.guide.twin.causes import Explained
from labcal.guide.twin.known_print import KnownPrint
from labcal.guide.twin.picture import TwinPicture
from labcal.guide.twin.posed import PosedViews
from labcal.guide.twin.residuals import DotResiduals
from labcal.guide.twin.unexplained_positions import Unexplained
from labcal.guide.twin.verdicts import PictureVerdict
from labcal.public_object import HtmlTable, PublicObject

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class DeclaredPrint:
    """Residuals of a simulation of the print as it is declared.

    Attributes
    ----------
    rms_px : float
        RMS residual of dots, 2-D.
    unexplained : tuple of Unexplained
        What moves dots, by rank.
    """

    rms_px: float
    unexplained: tuple[Unexplained, ...]


@dataclass(frozen=True, eq=False, repr=False)
class Twin(PublicObject):
    """A shoot rendered again with its calibrated rig, and compared with the photographs.

    Attributes
    ----------
    rig : Rig
    known : KnownPrint
        The print as it was rendered.
    growth_um : float
        By how much the radii of dots are larger than declared, as pictures show them, micrometres.
    posed : PosedViews
    pictures : tuple of TwinPicture
    residuals : DotResiduals
    explained : Explained
    verdicts : tuple of PictureVerdict
        By picture.
    unexplained : tuple of Unexplained
        What simulation does not explain, by rank.
    declared : DeclaredPrint or None
        What a simulation with the print as declared would not explain; None where the print is not measured.
    warnings : tuple of str

    Examples
    --------
    A twin is made by :func:`labcal.twin`:

    >>> from labcal.pipeline import TwinSettings
    >>> TwinSettings(views=2).views
    2
    """

    rig: Rig
    known: KnownPrint
    growth_um: float
    posed: PosedViews
    pictures: tuple[TwinPicture, ...]
    residuals: DotResiduals
    explained: Explained
    verdicts: tuple[PictureVerdict, ...]
    unexplained: tuple[Unexplained, ...]
    declared: DeclaredPrint | None
    warnings: tuple[str, ...]

    @property
    def pixel_variance(self) -> float:
        """Mean squared difference of pixels in units of the variance of the noise, over all pictures."""
        return _mean(self.pictures, lambda one: (one.pixels.variance, one.pixels.pixels))

    @property
    def flat_variance(self) -> float:
        """The same of pixels that show one colour."""
        return _mean(
            self.pictures, lambda one: (one.pixels.flat_variance, one.pixels.pixels - one.pixels.edge_pixels)
        )

    @property
    def edge_variance(self) -> float:
        """The same of pixels at the edges of dots."""
        return _mean(self.pictures, lambda one: (one.pixels.edge_variance, one.pixels.edge_pixels))

    @property
    def is_explained(self) -> bool:
        """True if simulation explains the residuals: nothing beyond noise is found."""
        return not self.unexplained

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line for each picture: residuals, noise, blur and differences of pixels.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        from labcal.extras import optional_module  # noqa: PLC0415 -- pandas is optional

        rows = [
            {
                "view": made.view,
                "camera": made.camera,
                "rms_px": verdict.rms_px,
                "noise_px": verdict.noise_px,
                "blur_px": made.blur_px,
                "flat_variance": made.pixels.flat_variance,
                "edge_variance": made.pixels.edge_variance,
            }
            for made, verdict in zip(self.pictures, self.verdicts, strict=True)
        ]
        frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(rows)
        return frame

    def _summary(self) -> Mapping[str, object]:
        return {
            "pictures": len(self.pictures),
            "rms": f"{self.residuals.rms_px:.3g} px",
            "explained": f"{100.0 * self.explained.noise:.0f}%",
            "unexplained": [one.kind for one in self.unexplained],
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [[one.kind, one.words] for one in self.unexplained]
        return [HtmlTable(("not explained", "words"), rows)]


def _mean(pictures: Sequence[TwinPicture], figure: Callable[[TwinPicture], tuple[float, int]]) -> float:
    pairs: Float64[np.ndarray, "n 2"] = np.array([figure(one) for one in pictures], dtype=np.float64)
    known = np.isfinite(pairs[:, 0]) & (pairs[:, 1] > 0)
    return float(np.average(pairs[known, 0], weights=pairs[known, 1])) if known.any() else float("nan")
