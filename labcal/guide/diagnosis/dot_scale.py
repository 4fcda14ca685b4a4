"""The scale of a target by the sizes of its dots in pictures."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Lengths
from labcal.calibrate.single_calibration import SingleCalibration
from labcal.cameras.dot_image import dot_images
from labcal.correspond.measure import Measurement
from labcal.distributions import f_tail
from labcal.guide.diagnosis.evidence import Evidence
from labcal.targets.grid import DotGrid

INK_MM = 0.1
"""Excess of a diameter by ink that spreads, or by toner that is melted, which no print is without."""
_FEWEST = 4
"""Views of which dots are measured."""
_EDGE = 0.4
"""Standard deviation of the shift of a camera's edges, in those of its blur, before the dots tell it.

A blurred edge between ink at 4% and paper at 75% of the light has, with the tone curve of sRGB, its half
level 0.48 standard deviations inside the ink; with a linear one it stays in its place.
"""
_CURVED = 0.25
"""Share of the shift by curvature that is uncertain: a tone curve does not keep the half level."""
_APART = 100_000
"""Between the numbers of the views of two cameras."""
_KEPT = 4.0
"""Robust standard deviations beyond which the size of a dot is no size of a whole dot."""


@dataclass(frozen=True)
class DotScale:
    """Ratio of the dots' diameters to their distances, over the declared one.

    Attributes
    ----------
    ratio, sigma : float
    diameter_mm : float
        Declared.
    spread_mm : float
        RMS distance of the dots of a view from their middle, as declared: of which a wrong scale is a share.
    views : int
    """

    ratio: float
    sigma: float
    diameter_mm: float
    spread_mm: float
    views: int

    @property
    def beyond_ink(self) -> float:
        """Deviation of the ratio from 1 that no spread of ink explains, share; 0 where it explains all.

        Ink spreads by at most 0.1 mm of the diameter, outwards on light paper, inwards of light dots.
        """
        allowed = INK_MM / self.diameter_mm
        return float(np.sign(self.ratio - 1.0) * max(0.0, abs(self.ratio - 1.0) - allowed))

    @property
    def p_value(self) -> float:
        """Probability of such a ratio with a print as declared, ink allowed for."""
        return f_tail((self.beyond_ink / max(self.sigma, 1e-12)) ** 2, 1, float(max(1, self.views - 2)))

    @property
    def pitch_percent(self) -> float:
        """Relative excess of the pitch if the diameter is right, %."""
        return 100.0 * (1.0 / self.ratio - 1.0)

    @property
    def diameter_percent(self) -> float:
        """Relative excess of the diameter if the pitch is right, %."""
        return 100.0 * (self.ratio - 1.0)

    @property
    def sigma_percent(self) -> float:
        """Standard deviation of the ratio, %."""
        return 100.0 * self.sigma

    @classmethod
    def of(cls, evidence: Evidence) -> "DotScale | None":
        """Return the ratio of sizes to distances; None where no pictures, or no dots, tell it.

        Notes
        -----
        Cameras that are calibrated alone predict the outline of each dot as declared. Of a disc of radius r,
        blurred by b, the half level is at ``r - b^2 / (2 r)`` (second order); a tone curve shifts it further
        by a share of b, which is fitted for each camera. Pictures that are exposed wrongly are left out. The
        variance is that of clusters, the views (Liang and Zeger 1986, "Longitudinal data analysis
        using generalized linear models"): dots of a view share their blur.
        """
        target = evidence.target
        if evidence.alone is None or not evidence.has_pictures or not isinstance(target, DotGrid):
            return None
        cameras = [_of_camera(evidence, one, target) for one in evidence.alone.alone]
        known = [one for one in cameras if len(set(one.view.tolist())) >= _FEWEST]
        if not known:
            return None
        ratio, sigma, views = _fitted(known)
        curved = np.concatenate([(one.blur / one.predicted) ** 2 for one in known])
        sigma = float(np.hypot(sigma, 0.5 * _CURVED * np.median(curved)))
        p = target.points()
        spread = float(np.sqrt(((p - p.mean(axis=0)) ** 2).sum(axis=1).mean()))
        return cls(ratio, sigma, float(np.median(target.outer_diameters_mm())), spread, views)


@dataclass(frozen=True)
class _Sizes:
    """Predicted and measured radii of a camera's dots, and the blur of their edges, px; numbers of views."""

    predicted: Lengths
    measured: Lengths
    blur: Lengths
    view: Int64[np.ndarray, " n"]

    @property
    def excess(self) -> Lengths:
        """Measured minus predicted radii, the curvature of blurred outlines allowed for, px."""
        return np.asarray(self.measured - self.predicted + 0.5 * self.blur**2 / self.predicted)


def _of_camera(evidence: Evidence, one: SingleCalibration, target: DotGrid) -> _Sizes:
    """Return the sizes of a camera's dots: geometric means of semi-axes."""
    pictures = {
        m.source.view: (m, look)
        for m, look in zip(evidence.measurements, evidence.looks, strict=True)
        if m.source.camera == one.name and look is not None and look.exposure_words is None
    }
    radii, p = 0.5 * target.outer_diameters_mm(), target.points()
    number = {tuple(index): at for at, index in enumerate(target.indices().tolist())}
    camera = replace(one.single.camera, T_cam_world=np.eye(4))
    parts = [(np.empty(0), np.empty(0), np.empty(0), np.empty(0, dtype=np.int64))]
    for at, (view, T) in enumerate(zip(one.dots.views, one.single.T_cam_target, strict=True)):
        if view not in pictures or not np.isfinite(pictures[view][1].edge_width_px):
            continue
        dot, measured = _measured(pictures[view][0], number)
        images = dot_images(camera, T, p[dot], radii[dot])
        predicted = np.sqrt(_areas(images.outline) / np.pi)
        good = images.ok & np.isfinite(predicted) & np.isfinite(measured)
        count = int(good.sum())
        blur = np.full(count, pictures[view][1].edge_width_px / np.sqrt(2.0 * np.pi))
        parts.append((predicted[good], measured[good], blur, np.full(count, at, dtype=np.int64)))
    return _Sizes(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def _measured(picture: Measurement, number: dict[tuple[int, ...], int]) -> tuple[np.ndarray, Lengths]:
    """Return the numbers of a picture's measured dots on the target, and their radii, px."""
    dots = picture.dots
    if dots is None:
        return np.empty(0, dtype=np.int64), np.empty(0)
    on_target = [tuple(index) in number for index in dots.index.tolist()]
    good = dots.ok & dots.has_id & np.array(on_target, dtype=bool).reshape(-1)
    index = np.array([number[tuple(one)] for one in dots.index[good].tolist()], dtype=np.int64)
    outline = dots.outline[good]
    square = np.full(len(outline), np.nan)
    there = np.isfinite(outline).all(axis=(1, 2))
    square[there] = np.linalg.det(outline[there])
    return index, np.asarray(np.where(square > 0.0, np.abs(square), np.nan) ** 0.25)


def _areas(outlines: Float64[np.ndarray, "n samples 2"]) -> Float64[np.ndarray, " n"]:
    """Return the areas within closed curves, px squared."""
    x, y = outlines[..., 0], outlines[..., 1]
    return np.asarray(0.5 * np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)))


def _fitted(cameras: Sequence[_Sizes]) -> tuple[float, float, int]:
    """Return the ratio, its standard deviation, and the number of views of all cameras."""
    count = len(cameras)
    rows, rights, groups = [], [], []
    for at, one in enumerate(cameras):
        share = one.excess / one.predicted
        away = np.abs(share - np.median(share))
        good = away <= _KEPT * max(1.4826 * float(np.median(away)), 1e-3)
        row = np.zeros((int(good.sum()), 1 + count))
        row[:, 0], row[:, 1 + at] = one.predicted[good], one.blur[good]
        rows.append(row)
        rights.append(one.excess[good])
        groups.append(one.view[good] + _APART * at)
    X, y = np.concatenate(rows), np.concatenate(rights)
    names, number = np.unique(np.concatenate(groups), return_inverse=True)
    normal, right = X.T @ X, X.T @ y
    # Dots of a view share their errors, so that the prior weighs as one dot of all that a view has.
    prior = np.zeros((1 + count, 1 + count))
    own = y - X @ np.linalg.lstsq(X, y, rcond=None)[0]
    shared = float(np.var(np.bincount(number, weights=own) / np.bincount(number))) + 1e-6
    weight = len(y) / len(names) * shared / _EDGE**2
    prior[1:, 1:] = weight * np.eye(count)
    inverse = np.linalg.inv(normal + prior)
    found = inverse @ right
    slopes = np.zeros((len(names), 1 + count))
    np.add.at(slopes, number, X * (y - X @ found)[:, None])
    # The prior's own part: a shift drawn from it adds prior * shift to the right side.
    chance = slopes.T @ slopes * len(names) / (len(names) - 1.0) + _EDGE**2 * prior @ prior
    return 1.0 + float(found[0]), float(np.sqrt((inverse @ chance @ inverse)[0, 0])), len(names)
