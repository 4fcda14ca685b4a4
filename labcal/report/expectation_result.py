"""What to expect of a rig: baseline, angle, poses and errors at the working distance, as text for people."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from rich.console import Group
from rich.table import Table
from rich.text import Text

from labcal.cameras.camera_pair import CameraPair
from labcal.cameras.expected_errors import ErrorShares, ExpectedErrors

UNKNOWN = "not known"
"""In place of an amount that is not."""


@dataclass(frozen=True)
class SharesResult:
    """Standard deviations along one direction in the JSON document, mm; null where not known."""

    noise_mm: float
    calibration_mm: float
    print_mm: float
    """The part of the calibration's share by dots that are off on the print."""
    total_mm: float

    @classmethod
    def of(cls, shares: ErrorShares) -> "SharesResult":
        """Return the document of them."""
        return cls(shares.noise_mm, shares.calibration_mm, shares.print_mm, shares.total_mm)


@dataclass(frozen=True)
class ExpectedErrorsResult:
    """The key ``expected_errors`` in the JSON document of ``labcal calibrate``: where the target was."""

    distance_mm: float
    """Median distance of the target's dots from the middle between the cameras."""
    nearest_mm: float
    farthest_mm: float
    pixel_sigma_px: float
    """Standard deviation of a typical dot along each axis, with the variance component of the calibration."""
    depth: SharesResult
    """Along the direction of view."""
    sideways: SharesResult
    """Along one axis across it."""
    shape_mm: float
    """RMS 3-D error by the calibration that is left after a rigid motion of all points."""

    @classmethod
    def of(cls, expected: ExpectedErrors) -> "ExpectedErrorsResult":
        """Return the document of them."""
        return cls(
            expected.distance_mm,
            expected.nearest_mm,
            expected.farthest_mm,
            expected.pixel_sigma_px,
            SharesResult.of(expected.depth),
            SharesResult.of(expected.sideways),
            expected.shape_mm,
        )


def pair_lines(pairs: Sequence[CameraPair]) -> list[str]:
    """Return baseline and angle of every two cameras, a line each."""
    lines = []
    for pair in pairs:
        angle = f"angle between their axes {plus_minus(pair.angle_deg, pair.angle_sigma_deg)}°"
        if isfinite(pair.baseline_mm):
            angle = f"baseline {plus_minus(pair.baseline_mm, pair.baseline_sigma_mm)} mm, {angle}"
        lines.append(f"{pair.first} and {pair.second}: {angle}")
    return lines


def expectation_rows(expected: ExpectedErrorsResult) -> list[list[str]]:
    """Return the errors along each direction: by noise, by the calibration, its print, and together, mm."""
    return [
        [
            name,
            *(
                amount(one)
                for one in (shares.noise_mm, shares.calibration_mm, shares.print_mm, shares.total_mm)
            ),
        ]
        for name, shares in (("depth", expected.depth), ("sideways", expected.sideways))
        if isfinite(shares.noise_mm)
    ]


def expectation_table(expected: ExpectedErrorsResult) -> Group:
    """Return the errors to expect where the target was, for people."""
    table = Table("1 sigma [mm]", "by noise", "by the calibration", "its print alone", "together")
    for row in expectation_rows(expected):
        table.add_row(*row)
    words = Text(expectation_words(expected))
    return Group(words, table) if table.rows else Group(words)


def expectation_words(expected: ExpectedErrorsResult) -> str:
    """Return where the errors are expected, and what a rigid motion leaves of the calibration's share."""
    if not isfinite(expected.distance_mm):
        return "no place of the target is seen by all cameras: no error can be foretold"
    words = (
        f"error to expect where the target was, {amount(expected.distance_mm)} mm away "
        f"({amount(expected.nearest_mm)} to {amount(expected.farthest_mm)}), of dots known to "
        f"{amount(expected.pixel_sigma_px)} px along each axis"
    )
    if not isfinite(expected.depth.noise_mm):
        return f"{words}; one camera gives no depth"
    if not isfinite(expected.depth.calibration_mm):
        return f"{words}; the calibration's share is not known, since lenses were kept or are left open"
    return (
        f"{words}. The calibration's share is common to all points: after a rigid motion of all of them "
        f"{amount(expected.shape_mm)} mm RMS are left of it"
    )


def amount(value: float) -> str:
    """Return an amount with two significant digits; whole ones from 100 on."""
    if abs(value) >= 100.0 and isfinite(value):  # noqa: PLR2004 -- as said
        return f"{value:.0f}"
    return f"{float(f'{value:.2g}'):g}" if isfinite(value) else UNKNOWN


def plus_minus(value: float, sigma: float) -> str:
    """Return a value with its standard deviation, to two significant digits of the latter."""
    if not isfinite(sigma):
        return f"{value:.5g} ± {UNKNOWN}"
    if not sigma > 0.0:
        return f"{value:.5g}"
    digits = max(0, 1 - int(f"{sigma:.1e}"[4:]))
    return f"{value:.{digits}f} ± {sigma:.{digits}f}"
