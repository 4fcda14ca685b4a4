"""The rehearsal of a planned rig: forecast, recommended views, boards, and what limits it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.extras import optional_module
from labcal.guide.rehearsal.boards import COUNTS, BoardFit, ViewCount, board_fits, enough_views, view_counts
from labcal.guide.rehearsal.confirmation import Confirmation
from labcal.guide.rehearsal.dot_noise import DotNoise, DrawnPicture, drawn_pictures, measured_noise
from labcal.guide.rehearsal.forecast import Forecast, Sources, forecast
from labcal.guide.rehearsal.limits import Limit, limits_of
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rig_plan import RigPlan
from labcal.public_object import HtmlTable, PublicObject
from labcal.run.threads import one_blas_thread
from labcal.wording import counted

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas

_DRAWN = 8
"""Views of which pictures are drawn, at most."""
_FOUND = 0.9
"""Share of the dots that the detector should measure."""
_LEAST_SEEN = 0.9
"""Share of the volume that all cameras should see."""


@dataclass(frozen=True, eq=False, repr=False)
class Rehearsal(PublicObject):
    """The errors to expect of a planned rig, and what would lessen them.

    Attributes
    ----------
    plan : RigPlan
    rig : Rig
        The planned cameras with the covariance that a calibration will have; the first one is the world.
    forecast : Forecast
        Errors over the working volume.
    noise : DotNoise
        Of the target's dots, px.
    views : tuple of ndarray, shape (4, 4)
        Recommended poses of the target, ``T_first_target``, mm.
    pictures : tuple of DrawnPicture
        Pictures of some of these views, drawn, and how the detector fared in them.
    limits : tuple of Limit
        The one with the largest gain first.
    counts : tuple of ViewCount
    boards : tuple of BoardFit
    warnings : tuple of str
        What is not as it should be, for people.
    freed_mm : float
        RMS 3-D error where the calibration estimates the dots' places, too; NaN where the plan says so
        already, the print is exact, or the target does not allow it.
    confirmation : Confirmation or None
        Errors of the rendered rig; None if it was not asked for.

    Examples
    --------
    >>> from labcal import examples
    >>> examples.rehearsal().plot().axes[0].get_title()
    'Z = 450 mm'
    """

    plan: RigPlan
    rig: Rig
    forecast: Forecast
    noise: DotNoise
    views: tuple[Pose, ...]
    pictures: tuple[DrawnPicture, ...]
    limits: tuple[Limit, ...]
    counts: tuple[ViewCount, ...]
    boards: tuple[BoardFit, ...]
    warnings: tuple[str, ...]
    freed_mm: float = float("nan")
    confirmation: Confirmation | None = None

    @property
    def rms_mm(self) -> float:
        """RMS 3-D error over the working volume, mm: points' own pixels and the calibration."""
        return self.forecast.rms_mm

    @property
    def limited_by(self) -> str:
        """Name of the limit whose halving brings most."""
        return self.limits[0].name.value

    @property
    def enough_views(self) -> int | None:
        """Least number of views from which on twice as many bring less than a tenth; None if none does."""
        return enough_views(self.counts)

    @property
    def best_board(self) -> BoardFit | None:
        """The board with the least error of those that fit; None if none does."""
        fitting = [one for one in self.boards if np.isfinite(one.rms_mm) and one.found >= _FOUND]
        return min(fitting, key=lambda one: one.rms_mm, default=None)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the map: a line for each point of the volume, in the plan's frame, mm.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(self.map_columns())
        return frame

    def map_columns(self) -> dict[str, np.ndarray]:
        """Return the map by column: place, expected RMS 3-D error, its shares, depth and sideways, mm."""
        made = self.forecast
        x, y, z = made.grid.T
        return {
            "X_mm": x,
            "Y_mm": y,
            "Z_mm": z,
            "rms_mm": made.point_mm,
            "noise_mm": np.sqrt(np.trace(made.noise, axis1=1, axis2=2)),
            "calibration_mm": made.calibration_point_mm,
            "depth_mm": made.depth_mm,
            "sideways_mm": made.sideways_mm,
        }

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw the map of the expected error in slices of the volume, mm."""
        from labcal.guide.rehearsal.map_figure import map_figure  # noqa: PLC0415 -- imports matplotlib

        return map_figure(self.forecast)

    def _summary(self) -> Mapping[str, object]:
        return {
            "plan": self.plan.name,
            "rms": f"{self.rms_mm:.3g} mm",
            "calibration": f"{self.forecast.calibration_mm:.3g} mm",
            "limited_by": self.limited_by,
            "warnings": len(self.warnings),
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [[one.change, f"{one.after_mm:.3g}", f"{100.0 * one.gain:.0f}%"] for one in self.limits]
        return [HtmlTable(("change", "RMS error after it (mm)", "gain"), rows)]


@one_blas_thread()
def rehearsed(plan: RigPlan, seed: int) -> Rehearsal:
    """Rehearse a plan without rendering.

    Parameters
    ----------
    plan : RigPlan
    seed : int
        Of the poses to choose from, and of the noise of drawn pictures.

    Raises
    ------
    InputError
        A camera is impossible; too few poses show enough of the target; the detector finds next to nothing
        in drawn pictures; the views do not determine the cameras; or no point of the volume is seen by all.
    """
    planned = PlannedRig.of(plan)
    _require_seen_volume(planned)
    views = planned.views(plan.shoot.views, seed)
    some = views[:: -(-len(views) // _DRAWN)]
    pictures = drawn_pictures(planned.cameras, some, plan.target, plan.photometry, seed)
    noise = measured_noise(pictures)
    sources = Sources.of(plan, noise)
    made = forecast(planned, views, sources)
    further = planned.views(max(len(views), COUNTS[-1] - len(views)), seed + 1)
    return Rehearsal(
        plan=plan,
        rig=planned.rig.model_copy(update={"covariance": made.covariance}),
        forecast=made,
        noise=noise,
        views=tuple(views),
        pictures=tuple(pictures),
        limits=limits_of(planned, views, further, sources, made, seed),
        counts=view_counts(planned, views, further, sources),
        boards=board_fits(plan, sources, seed),
        warnings=_warnings(pictures, made),
        freed_mm=_with_freed_dots(plan, views, sources),
    )


def _with_freed_dots(plan: RigPlan, views: list[Pose], sources: Sources) -> float:
    """Return the RMS error where the dots are freed; NaN where that is planned already, or of no use."""
    target = plan.target
    if plan.shoot.free_dots or plan.print_sigma_mm == 0.0 or target.symmetric_indices(target.indices()[:1]):
        return float("nan")
    freed = plan.model_copy(update={"shoot": plan.shoot.model_copy(update={"free_dots": True})})
    try:
        return forecast(PlannedRig.of(freed), views, sources).rms_mm
    except InputError:
        return float("nan")


def _require_seen_volume(planned: PlannedRig) -> None:
    if not planned.seen(planned.grid).any():
        raise InputError(
            f"No point of the working volume of the plan '{planned.plan.name}' is seen by all cameras. Move "
            "the volume, or change the distance, the baseline or where the cameras look."
        )


def _warnings(pictures: Sequence[DrawnPicture], made: Forecast) -> tuple[str, ...]:
    found = []
    refused = [one for one in pictures if one.refusal]
    if refused:
        found.append(
            f"the detector refuses {counted(len(refused), 'picture')} of {len(pictures)} drawn ones "
            f"({', '.join(sorted({one.refusal for one in refused}))}): plan larger dots, or less tilt"
        )
    share = sum(one.found for one in pictures) / max(1, sum(one.whole for one in pictures))
    if share < _FOUND:
        found.append(
            f"the detector measures {100.0 * share:.0f}% of the dots in drawn pictures: plan larger dots, or "
            "less tilt"
        )
    seen = float(made.seen.mean())
    if seen < _LEAST_SEEN:
        found.append(
            f"all cameras see {100.0 * seen:.0f}% of the working volume, and figures are of that part: widen "
            "the field of view, or move the cameras"
        )
    return tuple(found)
