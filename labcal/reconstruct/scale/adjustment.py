"""The adjustment of named points to scale bars, by generalised least squares."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float64, Int64

from labcal.cameras.derivatives import RUN
from labcal.correspond.named_points import NamedPoints
from labcal.errors import InputError, UnknownNameError
from labcal.reconstruct.named_reconstruction import NamedReconstruction
from labcal.reconstruct.point_budget import PointBudget
from labcal.reconstruct.scale.fitted_scale import BarResidual, FittedScale
from labcal.reconstruct.scale.scale_bar import ScaleBar
from labcal.reconstruct.scale.scaled_budget import BarEquations, ScaledBudget

_UNKNOWN = 1e-2
"""Standard deviation of a scale of which nothing is known beforehand: prints are off by less."""
_STEPS, _ARRIVED_MM = 20, 1e-10
Ends = Int64[np.ndarray, "J 2"]


def adjusted_to_bars(
    found: NamedReconstruction, bars: Sequence[ScaleBar], scale_sigma: float | None = None
) -> NamedReconstruction:
    """Return points to which known distances between some of them were added as observations.

    Parameters
    ----------
    found : NamedReconstruction
        Points of a rig, in its world.
    bars : sequence of ScaleBar
        Each is observed in every view that has both of its points.
    scale_sigma : float, optional
        Standard deviation of the rig's scale, relative: how far off the target's pitch may be. If left out,
        nothing is known of it, and the bars alone give the scale.

    Raises
    ------
    InputError
        The points are those of a fitted method, or no view has both points of a bar.

    Notes
    -----
    Unknown are the errors of the cameras (their joint covariance is known), of the scale, the noise of the
    bars' ends and the errors of the stated lengths. A scale of which nothing is known is taken from the
    lengths first, so that what is left is small. Measured minus stated length is a linear function of all
    of them; the best estimate is that of generalised least squares, repeated at the corrected points. All
    other points move with the cameras and the scale.
    """
    if not isinstance(found.budget, PointBudget):
        raise InputError(
            "Scale bars correct the cameras of a rig, but these points are those of a fitted method. Measure "
            "with a rig, as 'labcal calibrate' makes one, or use a frame by known points with a scale."
        )
    ends, number = _ends(found.points, bars)
    length = np.array([bar.length_mm for bar in bars])[number]
    sigma = np.array([bar.sigma_mm for bar in bars])
    prior = _UNKNOWN if scale_sigma is None else scale_sigma
    measured = found.points.point[ends]
    ratio = 1.0 if scale_sigma is not None else _ratio(_lengths(measured), length)
    corrected = ratio * measured
    for _ in range(_STEPS):
        equations = _equations(found.budget, ratio, ends, corrected, (number, sigma), prior)
        budget = ScaledBudget(found.budget, ratio, equations)
        # Misclosures at the corrected ends, as they would be without the corrections.
        off = _lengths(corrected) - length + _along(corrected, ratio * measured - corrected)
        moved = budget.corrected(ends.ravel(), off).reshape(corrected.shape)
        step, corrected = float(np.abs(moved - corrected).max()), moved
        if step < _ARRIVED_MM:
            break
    scale, of_scale = equations.gains[1][-1], (equations.by_cameras @ equations.cameras)[:, -1]
    without = equations.covariance - prior**2 * np.outer(
        equations.by_cameras[:, -1], equations.by_cameras[:, -1]
    )
    fitted = FittedScale(
        1e6 * ((1.0 + float(scale @ off)) / ratio - 1.0),
        1e6 * float(np.sqrt(max(0.0, prior**2 - float(scale @ of_scale)))),
        float(off @ np.linalg.solve(equations.covariance, off)),
        len(ends) - (scale_sigma is None),
        tuple(
            BarResidual(str(found.points.view[a]), bars[at].one, bars[at].other, bars[at].length_mm, *figures)
            for (a, _), at, *figures in zip(
                ends.tolist(),
                number.tolist(),
                _lengths(measured).tolist(),
                _lengths(corrected).tolist(),
                np.sqrt(np.diagonal(without)).tolist(),
                strict=True,
            )
        ),
    )
    return _with_scale(found, budget, off, fitted)


def _with_scale(
    found: NamedReconstruction, budget: ScaledBudget, off: Float64[np.ndarray, " J"], fitted: FittedScale
) -> NamedReconstruction:
    """Return the points with their corrections taken off, and with the covariances that are left."""
    points = np.empty_like(found.points.point)
    for first in range(0, len(points), RUN):
        rows = np.arange(first, min(first + RUN, len(points)))
        points[rows] = budget.corrected(rows, off)
    given = found.points
    covariance = budget.noise + budget.calibration
    moved = NamedPoints(given.view, given.name, points, covariance, given.flag)
    return replace(found, points=moved, budget=budget, scale=fitted)


def _ends(points: NamedPoints, bars: Sequence[ScaleBar]) -> tuple[Ends, Int64[np.ndarray, " J"]]:
    """Return the lines of both ends of bars in all views that have both, and the number of each bar."""
    placed = np.isfinite(points.point).all(axis=1) & np.isfinite(points.covariance).all(axis=(1, 2))
    found: list[tuple[int, int, int]] = []
    for number, bar in enumerate(bars):
        lines = []
        for name in (bar.one, bar.other):
            of_name = np.flatnonzero(points.name == name)
            if not len(of_name):
                raise UnknownNameError("point", name, dict.fromkeys(points.name.tolist()))
            lines.append({str(points.view[line]): line for line in of_name[placed[of_name]].tolist()})
        both = [(lines[0][view], lines[1][view], number) for view in lines[0] if view in lines[1]]
        if not both:
            raise InputError(
                f"No view has places for both ends of {bar.name}. See the flags of these points, or leave it "
                "out."
            )
        found += both
    every = np.array(found, dtype=np.int64)
    return every[:, :2], every[:, 2]


def _ratio(measured: Float64[np.ndarray, " J"], stated: Float64[np.ndarray, " J"]) -> float:
    """Return the ratio of stated to measured lengths, longer ones weighing more."""
    return float((measured @ stated) / (measured @ measured))


def _equations(
    budget: PointBudget,
    ratio: float,
    ends: Ends,
    place: Float64[np.ndarray, "J 2 3"],
    bars: tuple[Int64[np.ndarray, " J"], Float64[np.ndarray, " bars"]],
    prior: float,
) -> BarEquations:
    """Return the equations of bars, linearised at places of their ends."""
    number, sigma = bars
    lines, at = np.unique(ends, return_inverse=True)
    at = at.reshape(ends.shape)
    inside = budget.errors(lines)
    by_cameras = ratio * np.concatenate([inside.by_cameras, budget.point[lines][:, :, None]], axis=2)
    noise = np.zeros((3 * len(lines), 3 * len(lines)))
    for place_of, own in enumerate(inside.own):
        rows = slice(3 * place_of, 3 * place_of + 3)
        noise[rows, rows] = ratio**2 * own
    cameras = np.zeros((by_cameras.shape[2],) * 2)
    cameras[:-1, :-1], cameras[-1, -1] = inside.cameras, prior**2
    unit = _units(place)
    by_ends, by_bars = np.zeros((len(ends), 3 * len(lines))), np.zeros((len(ends), len(sigma)))
    for row in range(len(ends)):
        a, b = int(at[row, 0]), int(at[row, 1])
        by_ends[row, 3 * a : 3 * a + 3], by_ends[row, 3 * b : 3 * b + 3] = -unit[row], unit[row]
        by_bars[row, number[row]] = -1.0
    between = by_cameras[at[:, 1]] - by_cameras[at[:, 0]]
    return BarEquations(
        lines, noise, cameras, np.diag(sigma**2), by_ends, np.einsum("ji,jic->jc", unit, between), by_bars
    )


def _lengths(place: Float64[np.ndarray, "J 2 3"]) -> Float64[np.ndarray, " J"]:
    return np.asarray(np.linalg.norm(place[:, 1] - place[:, 0], axis=1))


def _units(place: Float64[np.ndarray, "J 2 3"]) -> Float64[np.ndarray, "J 3"]:
    """Return the directions of bars."""
    length = _lengths(place)
    if not (length > 0.0).all():
        raise InputError("Both ends of a scale bar were measured in the same place. Leave the bar out.")
    return np.asarray((place[:, 1] - place[:, 0]) / length[:, None])


def _along(
    place: Float64[np.ndarray, "J 2 3"], off: Float64[np.ndarray, "J 2 3"]
) -> Float64[np.ndarray, " J"]:
    """Return by how much differences of the ends lengthen bars."""
    return np.asarray(np.einsum("ji,ji->j", _units(place), off[:, 1] - off[:, 0]))
