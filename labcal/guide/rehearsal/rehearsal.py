"""The rehearsal of a planned rig: forecast, recommended views, boards, and what limits it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from labcal.arrays import Pose
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.extras import optional_module
from labcal.guide.rehearsal.boards import (
    COUNTS,
    BoardFit,
    ViewCount,
    board_fits,
    enough_views,
    rms_or_nan,
    view_counts,
)
from labcal.guide.rehearsal.confirmation import Confirmation
from labcal.guide.rehearsal.dot_noise import DotNoise, DrawnPicture, drawn_pictures, measured_noise
from labcal.guide.rehearsal.forecast import Forecast, forecast
from labcal.guide.rehearsal.limits import Limit, limits_of
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rig_plan import RigPlan
from labcal.guide.rehearsal.sources import Sources
from labcal.public_object import HtmlTable, PublicObject
from labcal.run.threads import one_blas_thread
from labcal.wording import counted

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas

_DRAWN = 8
"""Views of which pictures are drawn, at most."""
TEST_VIEWS = 4
"""Further views, whose dots a confirmation measures."""
_OTHER_POSES = 3
"""Further choices of poses, that tell how much the forecast depends on them."""
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
    test_views : tuple of ndarray, shape (4, 4)
        Further poses of the target, whose dots a confirmation measures, ``T_first_target``, mm.
    by_dot_places : mapping of DotTreatment to float
        RMS 3-D errors with the dots' places estimated, too, and as declared; without what is not possible.
    by_poses_mm : tuple of float
        RMS 3-D errors with other poses, chosen in the same way from other random ones.
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
    test_views: tuple[Pose, ...]
    by_dot_places: Mapping[DotTreatment, float]
    by_poses_mm: tuple[float, ...]
    confirmation: Confirmation | None = None

    @property
    def rms_mm(self) -> float:
        """RMS 3-D error over the working volume in the frame of the first camera, mm."""
        return self.forecast.rms_mm

    @property
    def shape_mm(self) -> float:
        """The same after a rigid alignment onto the truth: errors of shape and size, mm."""
        return self.forecast.shape_mm

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
        """Return the map by column: place, expected RMS 3-D errors, shares, depth and sideways, mm."""
        made = self.forecast
        x, y, z = made.grid.T
        return {
            "X_mm": x,
            "Y_mm": y,
            "Z_mm": z,
            "rms_mm": made.point_mm,
            "shape_mm": made.shape_point_mm,
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
            "shape": f"{self.shape_mm:.3g} mm",
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
        test_views=tuple(further[:TEST_VIEWS]),
        by_dot_places=_by_dot_places(plan, views, sources),
        by_poses_mm=_by_poses(planned, sources, seed + 2),
    )


def _by_poses(planned: PlannedRig, sources: Sources, seed: int) -> tuple[float, ...]:
    """Return the RMS errors with other poses that cover as much."""
    found = []
    for number in range(_OTHER_POSES):
        try:
            views = planned.views(planned.plan.shoot.views, seed + number)
        except InputError:
            continue
        found.append(rms_or_nan(planned, views, sources))
    return tuple(one for one in found if np.isfinite(one))


def _by_dot_places(plan: RigPlan, views: list[Pose], sources: Sources) -> dict[DotTreatment, float]:
    """Return the RMS errors by the treatment of the dots, where it makes a difference and is possible."""
    if plan.print_sigma_mm == 0.0:
        return {}
    found = {}
    for dots in (DotTreatment.FREED, DotTreatment.DECLARED):
        if dots is DotTreatment.FREED and plan.target.symmetric_indices(plan.target.indices()[:1]):
            continue
        shoot = plan.shoot.model_copy(update={"dot_places": dots})
        found[dots] = rms_or_nan(PlannedRig.of(plan.model_copy(update={"shoot": shoot})), views, sources)
    return {dots: rms_mm for dots, rms_mm in found.items() if np.isfinite(rms_mm)}


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
