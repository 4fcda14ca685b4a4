"""J'J and J'r of a bundle adjustment, in the blocks that its structure has."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.cameras.derivatives import point_derivatives, projection_derivatives
from labcal.optim.robust import Loss
from labcal.solve.adjustment.observations import Observations
from labcal.solve.adjustment.state import POSE, Layout, Lenses


@dataclass(frozen=True)
class Slopes:
    """J'r, or a step, or anything else with a number for every parameter."""

    shared: Float64[np.ndarray, " shared"]
    view: Float64[np.ndarray, "views 6"]


@dataclass(frozen=True)
class Blocks:
    """Views meet each other only through what all of them share."""

    shared: Float64[np.ndarray, "shared shared"]
    cross: Float64[np.ndarray, "views shared 6"]
    view: Float64[np.ndarray, "views 6 6"]
    gradient: Slopes


@dataclass(frozen=True)
class Rows:
    """Whitened derivatives and residuals of one camera's observations."""

    camera: Float64[np.ndarray, "n 2 own"]
    view: Float64[np.ndarray, "n 2 6"]
    dot: Float64[np.ndarray, "n 2 3"]
    residual: Float64[np.ndarray, "n 2"]


def _slopes(layout: Layout, observations: Observations, rows: Sequence[Rows]) -> Slopes:
    """Return J'r."""
    state = layout.state
    shared = np.zeros(layout.count)
    view = np.zeros((len(state.T_world_target), POSE))
    of_dots = np.zeros((len(state.dots), 3))
    for number, own in enumerate(rows):
        residual = own.residual
        at = observations.of_camera(number)
        columns = slice(layout.lens[number].start, layout.pose[number].stop)
        shared[columns] = np.tensordot(own.camera, residual, axes=([0, 1], [0, 1]))
        along = np.einsum("nki,nk->ni", own.view, residual)
        view += _summed(along, observations.view[at], len(view))
        if layout.freedom.dots.shape[1]:
            of_dot = np.einsum("nki,nk->ni", own.dot, residual)
            of_dots += _summed(of_dot, observations.dot[at], len(of_dots))
    shared[layout.dots] = layout.freedom.dots.T @ of_dots.ravel()
    return Slopes(shared, view)


def _summed(values: Float64[np.ndarray, "n width"], group: np.ndarray, groups: int) -> np.ndarray:
    """Return the sums of rows by group."""
    columns = [np.bincount(group, weights=column, minlength=groups) for column in values.T]
    return np.stack(columns, axis=-1)


def assemble(layout: Layout, observations: Observations, rows: Sequence[Rows]) -> Blocks:
    """Return the normal equations of all observations, linearised at a state.

    Parameters
    ----------
    layout : Layout
        The state, and what is free.
    observations : Observations
    rows : sequence of Rows
        By camera, of :func:`linearised_rows`.
    """
    state = layout.state
    views, dots = len(state.T_world_target), len(state.dots)
    free = layout.freedom.dots.shape[1]
    shared = np.zeros((layout.count, layout.count))
    cross, view = np.zeros((views, layout.count, POSE)), np.zeros((views, POSE, POSE))
    of_dots = _DotSums(dots, views, layout.count) if free else None
    for picture in observations.pictures:
        number, v = picture.camera, picture.view
        start = observations.of_camera(number).start
        at = slice(picture.rows.start - start, picture.rows.stop - start)
        own = slice(layout.lens[number].start, layout.pose[number].stop)
        width = own.stop - own.start
        A = np.concatenate([rows[number].camera[at], rows[number].view[at]], axis=2)
        flat = A.reshape(-1, A.shape[2])
        square = flat.T @ flat
        shared[own, own] += square[:width, :width]
        cross[v, own] = square[:width, width:]
        view[v] += square[width:, width:]
        if of_dots is not None:
            of_dots.add(rows[number].dot[at], A, own, v, observations.dot[picture.rows])
    if of_dots is not None:
        basis, at = layout.freedom.dots, layout.dots
        shared[at, at] = basis.T @ (of_dots.square @ basis.reshape(dots, 3, free)).reshape(-1, free)
        along = basis.T @ of_dots.shared.reshape(3 * dots, -1)
        shared[at] += along
        shared[:, at] += along.T
        by_view = of_dots.view.transpose(1, 2, 0, 3).reshape(3 * dots, views * POSE)
        cross[:, at] = (basis.T @ by_view).reshape(free, views, POSE).transpose(1, 0, 2)
    view[view[:, -1, -1] == 0.0] = np.eye(POSE)  # a view without observations stays where it is
    return Blocks(shared, cross, view, _slopes(layout, observations, rows))


class _DotSums:
    """Sums over observations for every dot by itself, before its freedom is applied."""

    def __init__(self, dots: int, views: int, shared: int) -> None:
        self.square = np.zeros((dots, 3, 3))
        self.shared = np.zeros((dots, 3, shared))
        self.view = np.zeros((views, dots, 3, POSE))

    def add(self, D: np.ndarray, A: np.ndarray, own: slice, view: int, seen: np.ndarray) -> None:
        """Add one picture: derivatives by dots, by camera and view together, and which dots."""
        turned = D.transpose(0, 2, 1)
        self.square[seen] += turned @ D
        product = turned @ A
        self.shared[seen, :, own] += product[:, :, :-POSE]
        self.view[view, seen] += product[:, :, -POSE:]


def linearised_rows(layout: Layout, observations: Observations, number: int, loss: Loss) -> Rows:
    """Return the derivatives of one camera's residuals by all that it depends on.

    Parameters
    ----------
    layout : Layout
    observations : Observations
    number : int
        The camera.
    loss : Loss
        Residuals are weighted by its slope (Triggs et al. 2000, "Bundle adjustment", section 4.3, without
        the term of second order).

    Notes
    -----
    With a pixel's derivative j by a point x of a frame, turning the frame's contents by w moves the point by
    ``w x x``, and the pixel by ``j (w x x) = w (x x j)``.
    """
    state = layout.state
    camera = state.cameras[number]
    at = observations.of_camera(number)
    T_world_target = state.T_world_target[observations.view[at]]
    R_cam_world, t = camera.T_cam_world[:3, :3], camera.T_cam_world[:3, 3]
    arm = np.einsum("nij,nj->ni", T_world_target[:, :3, :3], state.dots[observations.dot[at]])
    turned = (arm + T_world_target[:, :3, 3]) @ R_cam_world.T
    free = layout.freedom.lenses is Lenses.FREE
    found = (projection_derivatives if free else point_derivatives)(camera, turned + t)
    residual = np.einsum("nij,nj->ni", observations.whitener[at], found.q - observations.q[at])
    weight = np.sqrt(loss.weight((residual**2).sum(axis=1)))
    whitener = observations.whitener[at] * weight[:, None, None]
    by_point = whitener @ found.by_point
    by_world = by_point @ R_cam_world
    parts = []
    if free:
        parts.append(whitener @ found.by_camera)
    if number:
        parts += [np.cross(turned[:, None, :], by_point), by_point]
    return Rows(
        camera=np.concatenate(parts, axis=2) if parts else np.zeros((len(residual), 2, 0)),
        view=np.concatenate([np.cross(arm[:, None, :], by_world), by_world], axis=2),
        dot=by_world @ T_world_target[:, :3, :3],
        residual=residual * weight[:, None],
    )
