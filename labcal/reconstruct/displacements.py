"""Displacements of named points from view to view, with their uncertainty."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arguments import one_text
from labcal.arrays import PointCovariances, Vectors3
from labcal.cameras.derivatives import RUN
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import PointFlag
from labcal.errors import InputError, UnknownNameError
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable, PublicObject
from labcal.reconstruct.chosen_points import budget_of
from labcal.reconstruct.frames.framed_budget import FramedBudget
from labcal.reconstruct.named_reconstruction import NamedReconstruction
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.reconstruct.rigid_motion import RigidMotion, rigid_motion
from labcal.reconstruct.scale.scaled_budget import ScaledBudget
from labcal.wording import listed

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas

_FEWEST = 3
"""Points that a rigid motion takes."""


@dataclass(frozen=True, eq=False, repr=False)
class Displacements(PublicObject):
    """Displacements of points since a reference view, a line for each point of each other view.

    Attributes
    ----------
    reference_view : str
    view, name, flag : array of str, (n,)
        Views in order of appearance. The flag is that of the point or, where this is ``ok``, that of the same
        point in the reference view.
    displacement : float64 array, (n, 3)
        Mm; NaN where a point has no place in one of both views.
    covariance : float64 array, (n, 3, 3)
        Mm squared, from the joint covariance of both places: errors of the calibration all but cancel.
    budget : Budget
        The sources of errors that `covariance` holds.
    motions : dict of str to RigidMotion
        Rigid motion of the points of each view that are ``ok`` in both, where there are three or more that
        are not on a line.
    without_reference : tuple of str
        Names of points that the reference view does not have; they are not in the table.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples
    >>> moved = labcal.displacements(labcal.measure(examples.rig(), examples.moved_pixels()))
    >>> moved
    Displacements(reference_view='block', views=1, points=5, largest=2.06 mm, budget=noise)
    """

    reference_view: str
    view: np.ndarray
    name: np.ndarray
    displacement: Vectors3
    covariance: PointCovariances
    flag: np.ndarray
    budget: Budget
    motions: Mapping[str, RigidMotion]
    without_reference: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.view)

    @property
    def length_mm(self) -> Float64[np.ndarray, " n"]:
        """Lengths of the displacements."""
        return np.asarray(np.linalg.norm(self.displacement, axis=1))

    @property
    def views(self) -> tuple[str, ...]:
        """The views but the reference."""
        return tuple(dict.fromkeys(self.view.tolist()))

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write ``displacements.csv``: view, point, dX_mm, dY_mm, dZ_mm, covariance, flag.

        Raises
        ------
        OutputError
            The file exists and `force` is not set, or it cannot be written.
        """
        from labcal.reconstruct.displacements_csv import write_displacements  # noqa: PLC0415 -- it takes this class

        write_displacements(path, self, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the table with the columns of ``displacements.csv``.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        from labcal.reconstruct.displacements_csv import displacements_frame  # noqa: PLC0415 -- pandas is optional

        return displacements_frame(self)

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw the displacements of the points over the views, and the rigid motion with two sigmas."""
        from labcal.reconstruct.displacements_figure import displacements_figure  # noqa: PLC0415 -- matplotlib

        return displacements_figure(self)

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [
            [
                view,
                f"{np.linalg.norm(motion.displacement_mm):.4g}",
                f"{motion.sigma_displacement_mm.max():.2g}",
                f"{np.degrees(np.linalg.norm(motion.rotation_rad)):.4g}",
                f"{np.degrees(motion.sigma_rotation_rad.max()):.2g}",
                f"{motion.rms_mm:.3g}",
            ]
            for view, motion in self.motions.items()
        ]
        header = (
            "view",
            "rigid displacement (mm)",
            "sigma (mm)",
            "rotation (degrees)",
            "sigma (degrees)",
            "residual (mm)",
        )
        return [HtmlTable(header, rows)]

    def _summary(self) -> Mapping[str, object]:
        length = self.length_mm
        summary: dict[str, object] = {
            "reference_view": repr(self.reference_view),
            "views": len(self.views),
            "points": len(set(self.name.tolist())),
        }
        if np.isfinite(length).any():
            summary["largest"] = f"{np.nanmax(length):.3g} mm"
        return {**summary, "budget": self.budget.value}


def displacements(found: NamedReconstruction, reference_view: str | None = None) -> Displacements:
    """Return the displacements of named points of a rig since a reference view.

    Views are moments. Errors of the calibration act on all of them: of small displacements they all but
    cancel, so that these are known far better than the places.

    Parameters
    ----------
    found : NamedReconstruction
        Points of two views or more.
    reference_view : str, optional
        The first view if left out.

    Returns
    -------
    Displacements

    Raises
    ------
    InputError, InputTypeError
        There is no such view or no other one, the views have no point in common, or the points are not those
        of a rig.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples
    >>> moved = labcal.displacements(labcal.measure(examples.rig(), examples.moved_pixels()))
    >>> moved.displacement.mean(axis=0).round(1)
    array([2., 0., 0.])
    >>> moved.motions["moved"].displacement_mm.round(1)
    array([2., 0., 0.])
    """
    budget, points = budget_of(found), found.points
    views = tuple(dict.fromkeys(points.view.tolist()))
    reference = views[0] if reference_view is None else one_text(reference_view, "reference_view")
    if reference not in views:
        raise UnknownNameError("view in the points", reference, views)
    if len(views) == 1:
        raise InputError(
            f"All points are of one view, '{reference}'. Displacements take pixels of two moments or more, "
            "each a view of its own."
        )
    before, after, without = _pairs(points, reference)
    if not len(after):
        raise InputError(
            f"No point of the reference view '{reference}' was measured in another view. Points that are the "
            "same have the same name in all views."
        )
    flag = np.where(points.flag[after] == PointFlag.OK.value, points.flag[before], points.flag[after])
    motions: dict[str, RigidMotion] = {}
    usable = flag == PointFlag.OK.value
    for view in dict.fromkeys(points.view[after].tolist()):
        rows = np.flatnonzero(usable & (points.view[after] == view))
        if len(rows) >= _FEWEST and _is_spread(points.point[before[rows]]):
            motions[view] = rigid_motion(found, before[rows], after[rows])
    return Displacements(
        reference,
        points.view[after],
        points.name[after],
        points.point[after] - points.point[before],
        _covariances(budget, before, after),
        flag,
        budget.kind,
        motions,
        without,
    )


def _pairs(
    points: NamedPoints, reference: str
) -> tuple[Int64[np.ndarray, " n"], Int64[np.ndarray, " n"], tuple[str, ...]]:
    """Return lines of points in the reference view and after it, and names that this view does not have."""
    of_reference = np.flatnonzero(points.view == reference)
    line = dict(zip(points.name[of_reference].tolist(), of_reference.tolist(), strict=True))
    others = np.flatnonzero(points.view != reference)
    before = np.array([line.get(name, -1) for name in points.name[others].tolist()], dtype=np.int64)
    without = tuple(dict.fromkeys(points.name[others[before < 0]].tolist()))
    return before[before >= 0], others[before >= 0], without


def _covariances(
    budget: PointBudget | FramedBudget | ScaledBudget,
    before: Int64[np.ndarray, " n"],
    after: Int64[np.ndarray, " n"],
) -> PointCovariances:
    """Return the covariances of differences of points from their joint covariance."""
    found = np.empty((len(before), 3, 3))
    for first in range(0, len(before), RUN):
        rows = slice(first, first + RUN)
        one, other = budget.errors(before[rows]), budget.errors(after[rows])
        by_shared, by_cameras = other.by_shared - one.by_shared, other.by_cameras - one.by_cameras
        found[rows] = one.own + other.own
        found[rows] += by_shared @ one.shared @ by_shared.swapaxes(1, 2)
        found[rows] += by_cameras @ one.cameras @ by_cameras.swapaxes(1, 2)
    return 0.5 * (found + found.swapaxes(1, 2))


def _is_spread(points: Vectors3) -> bool:
    """Tell whether points are not all on a line."""
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[1] > 1e-9 * spread[0])


def displacement_warnings(found: Displacements) -> tuple[str, ...]:
    """Return warnings about points that are not in the table."""
    if not found.without_reference:
        return ()
    warning = (
        f"the reference view '{found.reference_view}' does not have the points "
        f"{listed(found.without_reference)}: they have no displacement"
    )
    return (warning,)
