"""J'J and J'r of a bundle adjustment, in the blocks that its structure has."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.cameras.derivatives import projection_derivatives
from labcal.optim.robust import Loss
from labcal.solve.adjustment.observations import Observations
from labcal.solve.adjustment.state import POSE, Layout, Lenses


@dataclass(frozen=True)
class Blocks:
    """Views meet each other only through what all of them share."""

    shared: Float64[np.ndarray, "shared shared"]
    cross: Float64[np.ndarray, "views shared 6"]
    view: Float64[np.ndarray, "views 6 6"]
    shared_gradient: Float64[np.ndarray, " shared"]
    view_gradient: Float64[np.ndarray, "views 6"]


@dataclass(frozen=True)
class _Rows:
    """Whitened derivatives and residuals of one camera's observations."""

    camera: Float64[np.ndarray, "n 2 own"]
    view: Float64[np.ndarray, "n 2 6"]
    dot: Float64[np.ndarray, "n 2 3"]
    residual: Float64[np.ndarray, "n 2"]


def assemble(layout: Layout, observations: Observations, loss: Loss) -> Blocks:
    """Return the normal equations of all observations, linearised at a state.

    Parameters
    ----------
    layout : Layout
        The state, and what is free.
    observations : Observations
    loss : Loss
        Residuals are weighted by its slope (Triggs et al. 2000, "Bundle adjustment", section 4.3, without
        the term of second order).
    """
    state = layout.state
    views, dots = len(state.T_world_target), len(state.dots)
    free = layout.freedom.dots.shape[1]
    shared = np.zeros((layout.count, layout.count))
    cross, view = np.zeros((views, layout.count, POSE)), np.zeros((views, POSE, POSE))
    gradient, view_gradient = np.zeros(layout.count), np.zeros((views, POSE))
    of_dots = _DotSums(dots, views, layout.count) if free else None
    for number in range(len(state.cameras)):
        rows = _rows(layout, observations, number, loss)
        start = observations.of_camera(number).start
        own = slice(layout.lens[number].start, layout.pose[number].stop)
        width = own.stop - own.start
        for picture in observations.pictures:
            if picture.camera != number:
                continue
            at, v = slice(picture.rows.start - start, picture.rows.stop - start), picture.view
            A = np.concatenate([rows.camera[at], rows.view[at]], axis=2)
            flat, r = A.reshape(-1, A.shape[2]), rows.residual[at].ravel()
            square, slope = flat.T @ flat, flat.T @ r
            shared[own, own] += square[:width, :width]
            cross[v, own] = square[:width, width:]
            view[v] += square[width:, width:]
            gradient[own] += slope[:width]
            view_gradient[v] += slope[width:]
            if of_dots is not None:
                D = rows.dot[at].transpose(0, 2, 1)
                seen = observations.dot[picture.rows]
                of_dots.square[seen] += D @ rows.dot[at]
                of_dots.shared[seen, :, own] += D @ rows.camera[at]
                of_dots.view[v, seen] += D @ rows.view[at]
                of_dots.gradient[seen] += (D @ rows.residual[at, :, None])[:, :, 0]
    if of_dots is not None:
        basis, at = layout.freedom.dots, layout.dots
        shared[at, at] = basis.T @ (of_dots.square @ basis.reshape(dots, 3, free)).reshape(-1, free)
        along = basis.T @ of_dots.shared.reshape(3 * dots, -1)
        shared[at] += along
        shared[:, at] += along.T
        by_view = of_dots.view.transpose(1, 2, 0, 3).reshape(3 * dots, views * POSE)
        cross[:, at] = (basis.T @ by_view).reshape(free, views, POSE).transpose(1, 0, 2)
        gradient[at] = basis.T @ of_dots.gradient.ravel()
    return Blocks(shared, cross, view, gradient, view_gradient)


class _DotSums:
    """Sums over observations for every dot by itself, before its freedom is applied."""

    def __init__(self, dots: int, views: int, shared: int) -> None:
        self.square = np.zeros((dots, 3, 3))
        self.shared = np.zeros((dots, 3, shared))
        self.view = np.zeros((views, dots, 3, POSE))
        self.gradient = np.zeros((dots, 3))


def _rows(layout: Layout, observations: Observations, number: int, loss: Loss) -> _Rows:
    """Return the derivatives of one camera's residuals by all that it depends on.

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
    found = projection_derivatives(camera, turned + t)
    residual = np.einsum("nij,nj->ni", observations.whitener[at], found.q - observations.q[at])
    weight = np.sqrt(loss.weight((residual**2).sum(axis=1)))
    whitener = observations.whitener[at] * weight[:, None, None]
    by_point = whitener @ found.by_point
    by_world = by_point @ R_cam_world
    parts = []
    if layout.freedom.lenses is Lenses.FREE:
        parts.append(whitener @ found.by_camera)
    if number:
        parts += [np.cross(turned[:, None, :], by_point), by_point]
    return _Rows(
        camera=np.concatenate(parts, axis=2) if parts else np.zeros((len(residual), 2, 0)),
        view=np.concatenate([np.cross(arm[:, None, :], by_world), by_world], axis=2),
        dot=by_world @ T_world_target[:, :3, :3],
        residual=residual * weight[:, None],
    )
