"""One camera in the result of ``labcal calibrate``: in the JSON document, and as a column for people."""

from collections.abc import Mapping
from dataclasses import dataclass

from rich.table import Table

from labcal.calibrate.budget.omitted_lens import omitted_coefficients
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_misfit import LensMisfit
from labcal.calibrate.one_lens import TwoLenses
from labcal.cameras.lens import lens_by_name
from labcal.report.expectation_result import plus_minus

_COLUMNS = 2
"""Cameras side by side: more do not fit in a terminal of 80 characters."""
_INTRINSICS = ("fx", "fy", "cx", "cy")


@dataclass(frozen=True)
class SigmaResult:
    """Standard deviations of a camera's numbers in the rig; null where the views leave one open."""

    fx: float
    fy: float
    cx: float
    cy: float
    dist: list[float]
    rotation_rad: list[float]
    translation_mm: list[float]


@dataclass(frozen=True)
class CameraResult:
    """One camera in the JSON document of ``labcal calibrate``."""

    rms_px: float
    """Of this camera calibrated alone."""
    rms_in_rig_px: float
    K: list[list[float]]
    lens: str
    dist: list[float]
    views: int
    dots: int
    sigma: SigmaResult
    scatter_px: float
    """Of this camera alone: what dots scatter along each axis beyond their covariances."""
    undetermined: list[str]
    """Lens coefficients that the views leave open."""
    open_lens: bool
    """True if the dots do not determine the lens towards the picture's border, where a prior decides."""
    share_without_rays: float
    """Of the picture, where the lens folds."""
    two_lenses: TwoLenses | None
    """Groups of views that were taken through different lenses, so that the numbers are of neither; null
    where one lens explains all."""
    lens_misfit: LensMisfit | None
    """A larger lens model that the views ask for, and the probability that chance alone does; null where the
    lens suits, or no model that contains it was tried."""
    omitted: list[str]
    """Coefficients that the lens model does not have, and whose possible size is in the rig's covariance."""

    @classmethod
    def of(cls, found: HandheldCalibration, name: str) -> "CameraResult":
        """Return the document of one camera."""
        record, fit = found.rig.cameras[name], found.fits[name]
        fx, fy, cx, cy = fit.sigma.intrinsics.tolist()
        return cls(
            rms_px=fit.rms_px,
            rms_in_rig_px=fit.rms_in_rig_px,
            K=[list(row) for row in record.K],
            lens=record.lens,
            dist=list(record.dist),
            views=len(fit.views),
            dots=fit.dots,
            sigma=SigmaResult(
                fx, fy, cx, cy,
                dist=fit.sigma.dist.tolist(),
                rotation_rad=fit.sigma.rotation_rad.tolist(),
                translation_mm=fit.sigma.translation_mm.tolist(),
            ),
            scatter_px=fit.scatter_px,
            undetermined=list(fit.undetermined),
            open_lens=fit.open_lens,
            share_without_rays=found.rig.camera(name).share_without_rays,
            two_lenses=fit.two_lenses,
            lens_misfit=fit.misfit,
            omitted=list(omitted_coefficients(record.lens)) if found.sources.omitted.size else [],
        )  # fmt: skip


def camera_tables(cameras: Mapping[str, CameraResult]) -> list[Table]:
    """Return the cameras with their standard deviations for people, some in a table."""
    names = list(cameras)
    return [
        _side_by_side({name: cameras[name] for name in names[first : first + _COLUMNS]})
        for first in range(0, len(names), _COLUMNS)
    ]


def _side_by_side(cameras: Mapping[str, CameraResult]) -> Table:
    """Return some cameras, a column each."""
    columns = [_figures(camera) for camera in cameras.values()]
    table = Table("", *cameras)
    for key in dict.fromkeys(key for column in columns for key in column):
        table.add_row(key, *(column.get(key, "") for column in columns))
    return table


def _figures(camera: CameraResult) -> dict[str, str]:
    """Return what is said of one camera, by name and unit."""
    sigma = camera.sigma
    (fx, _, cx), (_, fy, cy), _ = camera.K
    intrinsics = zip(_INTRINSICS, (fx, fy, cx, cy), (sigma.fx, sigma.fy, sigma.cx, sigma.cy), strict=True)
    coefficients = zip(lens_by_name(camera.lens).names, camera.dist, sigma.dist, strict=False)
    figures = {
        "views, dots": f"{camera.views}, {camera.dots}",
        "RMS alone, in the rig [px]": f"{camera.rms_px:.4f}, {camera.rms_in_rig_px:.4f}",
        "lens": camera.lens,
        **{f"{name} [px]": plus_minus(value, one) for name, value, one in intrinsics},
        **{name: plus_minus(value, one) for name, value, one in coefficients},
    }
    if any(sigma.rotation_rad) or any(sigma.translation_mm):  # not of the first camera, which is the world
        turns, shifts = ([1e3 * one for one in sigma.rotation_rad], sigma.translation_mm)
        figures["rotation about x, y, z, ± [mrad]"] = ", ".join(f"{one:.2g}" for one in turns)
        figures["place along x, y, z, ± [mm]"] = ", ".join(f"{one:.2g}" for one in shifts)
    return figures
