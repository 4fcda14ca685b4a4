"""Rays cast from the rough centres of spots, and ellipses through where they meet the edge."""

from math import cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled

_QUARTERS = 1.349
"""Standard deviations between a quarter and three quarters of an error function."""
_SHARPEST = 0.1
"""Of an edge's squared width: so much is left when that of sampling is subtracted."""
_TERMS = 5
_SINGULAR = 1e-12
_ROUND = 0.05
"""Least determinant of an ellipse in coordinates that make it nearly a unit circle."""
COLUMNS = 7
"""Centre 2, outline matrix xx xy yy, brightness of the middle, blur (px)."""


class RayLimits(NamedTuple):
    """The settings of segmentation that compiled code takes."""

    ray_step_px: float
    min_ray_samples: int
    max_ray_samples: int
    edge_search_radii: float
    dot_level_from_radii: float
    dot_level_to_radii: float
    board_level_share: float
    min_ray_share: float
    ellipse_rounds: int
    outlier_factor: float
    outlier_share: float
    max_roughness_share: float
    max_roughness_px: float
    max_offset_radii: float
    min_outline_axis_px: float


def ray_directions(count: int) -> np.ndarray:
    """Return unit vectors (count, 2), evenly around."""
    angles = [2.0 * pi * ray / count for ray in range(count)]
    return np.array([[cos(angle), sin(angle)] for angle in angles])


@compiled
def _cast(grey: np.ndarray, start: tuple[float, float], step: tuple[float, float], ray: np.ndarray) -> None:
    """Write bilinear grey values along a ray; beyond the frame they are those of the border."""
    height, width = grey.shape
    last = len(ray) - 1
    end_x, end_y = start[0] + last * step[0], start[1] + last * step[1]
    low_x, high_x = min(start[0], end_x), max(start[0], end_x)
    low_y, high_y = min(start[1], end_y), max(start[1], end_y)
    inside = low_x >= 0.0 and low_y >= 0.0 and high_x < width - 1 and high_y < height - 1
    for k in range(last + 1):
        x, y = start[0] + k * step[0], start[1] + k * step[1]
        if not inside:
            x, y = min(max(x, 0.0), width - 1.001), min(max(y, 0.0), height - 1.001)
        i, j = int(y), int(x)
        p, q = x - j, y - i
        upper = grey[i, j] + p * (grey[i, j + 1] - grey[i, j])
        lower = grey[i + 1, j] + p * (grey[i + 1, j + 1] - grey[i + 1, j])
        ray[k] = upper + q * (lower - upper)


@compiled
def _rise(profile: np.ndarray, first: int, level: float, spacing: float) -> float:
    """Return where a profile first rises through a level past `first`, in radii, infinite where never."""
    for k in range(first + 1, len(profile)):
        if profile[k] >= level:
            low = profile[k - 1]
            if low >= level:
                return np.inf
            at: float = spacing * (k - 1 + (level - low) / max(profile[k] - low, 1e-30))
            return at
    return np.inf


@compiled
def _middle_of_five(values: np.ndarray, first: int, five: np.ndarray) -> float:
    """Return the median of five neighbours in a ring of values."""
    for k in range(5):
        place = first + k
        value, at = values[place if place < len(values) else place - len(values)], k
        while at > 0 and five[at - 1] > value:
            five[at] = five[at - 1]
            at -= 1
        five[at] = value
    middle: float = five[2]
    return middle


@compiled
def _ellipse(points: np.ndarray, found: np.ndarray, limits: RayLimits, terms: np.ndarray) -> float:
    """Fit ``a x^2 + 2 b x y + c y^2 + d x + e y = 1`` to points near the unit circle, into `terms`.

    Returns the median distance of the points from the ellipse, infinite where there is none; points that lie
    off are left out in some rounds.
    """
    count = len(points)
    use, residual = found.copy(), np.empty(count)
    normal, row = np.empty((_TERMS, _TERMS)), np.empty(_TERMS)
    for _ in range(limits.ellipse_rounds):
        normal[:] = 0.0
        terms[:] = 0.0
        for k in range(count):
            x, y = points[k, 0], points[k, 1]
            row[0], row[1], row[2], row[3], row[4] = x * x, 2.0 * x * y, y * y, x, y
            if use[k]:
                for i in range(_TERMS):
                    terms[i] += row[i]
                    for j in range(i + 1):
                        normal[i, j] += row[i] * row[j]
        for i in range(_TERMS):
            normal[i, i] += 1e-9
        if not factorise(normal, _TERMS, _SINGULAR):
            return np.inf
        solve(normal, terms)
        _write_residuals(points, found, terms, residual)
        limit = max(
            limits.outlier_factor * np.median(residual), limits.outlier_share
        )  # the median of a spot without edges is infinite
        if not _narrow(use, found, residual, limit):  # nor would the next fit be another
            break
    if (
        use.sum() < limits.min_ray_share * count
        or terms[0] <= 0.0
        or terms[0] * terms[2] - terms[1] ** 2 <= _ROUND
    ):
        return np.inf
    return 0.5 * np.median(residual)  # the residual is that of the radius squared


@compiled
def _write_residuals(points: np.ndarray, found: np.ndarray, terms: np.ndarray, residual: np.ndarray) -> None:
    """Write how far points are from an ellipse, of the squared radius; infinite for those not found."""
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        value = terms[0] * x * x + 2.0 * terms[1] * x * y + terms[2] * y * y
        residual[k] = abs(value + terms[3] * x + terms[4] * y - 1.0) if found[k] else np.inf


@compiled
def _narrow(use: np.ndarray, found: np.ndarray, residual: np.ndarray, limit: float) -> bool:
    """Replace the points in use by those found within a limit, in place; return whether they change."""
    changed = False
    for k in range(len(use)):
        keep = found[k] and residual[k] < limit
        changed |= keep != use[k]
        use[k] = keep
    return changed


@compiled
def trace_all(
    grey: np.ndarray,
    spots: np.ndarray,
    rays: np.ndarray,
    sizes: tuple[float, float],
    limits: RayLimits,
    table: np.ndarray,
) -> np.ndarray:
    """Trace spots (centre, and root of the outline matrix: xx xy yy) into `table`; return which have an edge.

    Along each ray the edge is where the grey value rises half-way from the dot to the board beside that ray;
    an ellipse is fitted to these points. The rays are unit vectors; the sizes are how far board surrounds a
    dot, and the radius of a ring's hole, both in radii.
    """
    reach, hole_radius = sizes
    count = len(rays)
    ok = np.zeros(len(spots), dtype=np.bool_)
    points, outside, around = np.empty((count, 2)), np.empty(count), np.empty(5)
    found, edge, soft = np.empty(count, dtype=np.bool_), np.empty(count), np.empty(count)
    terms = np.empty(_TERMS)
    for number in range(len(spots)):
        x, y, a, b, c = spots[number]
        radius = sqrt(abs(a * c - b * b))
        steps = int(
            min(max(reach * radius / limits.ray_step_px, limits.min_ray_samples), limits.max_ray_samples)
        )
        spacing = reach / steps
        profile = np.empty((count, steps + 1))
        for ray in range(count):
            u, v = rays[ray]
            along_x, along_y = (a * u + b * v) * spacing, (b * u + c * v) * spacing
            _cast(grey, (x, y), (along_x, along_y), profile[ray])
        inner = int(limits.dot_level_from_radii / spacing) + 1
        outer = max(int(limits.dot_level_to_radii / spacing), inner)
        inside = np.median(profile[:, inner : outer + 1])
        beside = min(int((1.0 + limits.board_level_share * (reach - 1.0)) / spacing) + 1, steps)
        for ray in range(count):
            outside[ray] = profile[ray, beside:].mean()
        first = int(limits.edge_search_radii / spacing)
        board = 0.0
        for ray in range(count):
            level = _middle_of_five(outside, ray - 2, around)
            board += level / count
            # From the darkest place, because in a small ring the blurred hole shines where the search begins.
            darkest = first + int(np.argmin(profile[ray, first : int(1.0 / spacing) + 1]))
            edge[ray] = _rise(profile[ray], darkest, 0.5 * (inside + level), spacing)
            found[ray] = np.isfinite(edge[ray])
            u, v = rays[ray]
            points[ray, 0], points[ray, 1] = edge[ray] * u, edge[ray] * v
            low = _rise(profile[ray], darkest, 0.75 * inside + 0.25 * level, spacing)
            high = _rise(profile[ray], darkest, 0.25 * inside + 0.75 * level, spacing)
            length = sqrt((a * u + b * v) ** 2 + (b * u + c * v) ** 2)
            # Sampling between pixels, and between samples, has widened the edge.
            wide, sampled = (high - low) * length / _QUARTERS, (1.0 + (spacing * length) ** 2) / 6.0
            soft[ray] = sqrt(max(wide**2 - sampled, _SHARPEST * wide**2)) if np.isfinite(wide) else np.nan
            if not found[ray]:
                points[ray, 0], points[ray, 1] = 0.0, 0.0
        # A ring of the body of a ring-shaped dot is as dark as the dot; its middle may not be.
        body = round(0.5 * (hole_radius + 1.0) / spacing)
        dark, middle = profile[:, body].mean(), profile[:, : max(int(0.5 * hole_radius / spacing), 1)].mean()
        rough = _ellipse(points, found, limits, terms)
        small = 0.5 * (a + c) - sqrt(0.25 * (a - c) ** 2 + b * b)
        smooth = rough < limits.max_roughness_share + limits.max_roughness_px / small
        if not (small > limits.min_outline_axis_px and smooth and board > dark):
            continue
        ok[number] = _write(table[number], spots[number], terms, limits.max_offset_radii)
        table[number, 5] = (middle - dark) / (board - dark)
        table[number, 6] = np.nanmedian(soft)
    return ok


@compiled
def _write(row: np.ndarray, spot: np.ndarray, terms: np.ndarray, farthest: float) -> bool:
    """Write an ellipse of flat coordinates as centre and outline matrix in px; False where it lies off."""
    p, q, r, d, e = terms
    determinant = p * r - q * q
    u, v = -0.5 * (r * d - q * e) / determinant, -0.5 * (p * e - q * d) / determinant
    if u * u + v * v >= farthest * farthest:
        return False
    scale = 1.0 + p * u * u + 2.0 * q * u * v + r * v * v
    # The outline matrix is back times the inverse of the flat one times back.
    xx, xy, yy = r / determinant * scale, -q / determinant * scale, p / determinant * scale
    a, b, c = spot[2], spot[3], spot[4]
    row[0], row[1] = spot[0] + a * u + b * v, spot[1] + b * u + c * v
    row[2] = a * a * xx + 2.0 * a * b * xy + b * b * yy
    row[3] = a * b * xx + (a * c + b * b) * xy + b * c * yy
    row[4] = b * b * xx + 2.0 * b * c * xy + c * c * yy
    return True


@compiled
def distinct(centre: np.ndarray, radius: np.ndarray, closeness: float) -> np.ndarray:
    """Return the indices of the first of every group of spots of nearly one centre and size."""
    kept = np.empty(len(centre), dtype=np.int64)
    count = 0
    for i in range(len(centre)):
        same = False
        far = closeness * radius[i]
        for k in range(count):
            j = kept[k]
            dx, dy = centre[i, 0] - centre[j, 0], centre[i, 1] - centre[j, 1]
            if dx * dx + dy * dy < far * far and abs(np.log(radius[i] / radius[j])) < closeness:
                same = True
                break
        if not same:
            kept[count] = i
            count += 1
    return kept[:count].copy()
