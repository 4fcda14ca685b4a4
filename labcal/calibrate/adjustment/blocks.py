"""J'J and J'r of a bundle adjustment, in the blocks that its structure has."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.dot_sums import DotSums
from labcal.calibrate.adjustment.observations import Observations, Run
from labcal.calibrate.adjustment.rows import linearised_rows
from labcal.calibrate.adjustment.state import POSE, Layout
from labcal.optim.robust import Loss


@dataclass(frozen=True)
class Slopes:
    """A vector with one value for every parameter: J'r, a step or the like."""

    shared: Float64[np.ndarray, " shared"]
    view: Float64[np.ndarray, "views 6"]


@dataclass(frozen=True)
class Blocks:
    """Normal equations in blocks: views are coupled only by the shared parameters."""

    shared: Float64[np.ndarray, "shared shared"]
    cross: Float64[np.ndarray, "views shared 6"]
    view: Float64[np.ndarray, "views 6 6"]
    gradient: Slopes


def assemble(layout: Layout, observations: Observations, loss: Loss) -> Blocks:
    """Return the normal equations of all observations, linearised at a state.

    Parameters
    ----------
    layout : Layout
        The state, and what is free.
    observations : Observations
    loss : Loss
    """
    views, free = len(layout.state.T_world_target), layout.freedom.dots.shape[1]
    blocks = Blocks(
        np.zeros((layout.count, layout.count)),
        np.zeros((views, layout.count, POSE)),
        np.zeros((views, POSE, POSE)),
        Slopes(np.zeros(layout.count), np.zeros((views, POSE))),
    )
    of_dots = DotSums(len(layout.state.dots), views, layout.count) if free else None
    for number in range(len(layout.state.cameras)):
        pictures = [picture for picture in observations.pictures if picture.camera == number]
        seen = np.array([picture.view for picture in pictures], dtype=np.int64)
        moves = picture_moves(layout, number, layout.state.T_world_target[seen])
        squares = np.empty((len(seen), moves.shape[1], moves.shape[1]))
        done = 0
        for run in (run for run in observations.runs if run.camera == number):
            rows = linearised_rows(layout, observations, run, loss)
            here = slice(done, done + len(run.pictures))
            squares[here] = _squares(rows, run)
            if of_dots is not None:
                for (picture, at), move in zip(run.within(), moves[here], strict=True):
                    of_dots.add(layout, picture, rows[:, :, at], move, observations.dot[picture.rows])
            done = here.stop
        _add(blocks, layout.own(number), seen, moves.transpose(0, 2, 1) @ (squares @ moves))
    if of_dots is not None:
        of_dots.enter(layout, blocks.shared, blocks.cross, blocks.gradient.shared)
    blocks.view[~blocks.view.any(axis=(1, 2))] = np.eye(POSE)  # a view without observations stays where it is
    return blocks


def _squares(rows: Float64[np.ndarray, "width 2 n"], run: Run) -> Float64[np.ndarray, "pictures width width"]:
    """Return the products of the rows of each picture of a run."""
    width = len(rows)
    if (run.counts == run.counts[0]).all():  # then in half the time
        of_picture = rows.reshape(width, 2, len(run.pictures), -1).transpose(2, 1, 0, 3)
        return np.asarray((of_picture @ of_picture.transpose(0, 1, 3, 2)).sum(axis=1))
    squares = np.empty((len(run.pictures), width, width))
    for square, (_, at) in zip(squares, run.within(), strict=True):
        of_u, of_v = rows[:, 0, at], rows[:, 1, at]
        square[...] = of_u @ of_u.T + of_v @ of_v.T
    return squares


def picture_moves(
    layout: Layout, number: int, T_world_target: Float64[np.ndarray, "pictures 4 4"]
) -> Float64[np.ndarray, "pictures width parameters"]:
    """Return the derivatives of what a camera's rows depend on by the parameters, in each of its pictures.

    Parameters are the lens, the camera's pose (but for the first), the view's pose; the residual stays last.
    """
    T_cam_world = layout.state.cameras[number].T_cam_world
    R_cam_world = T_cam_world[:3, :3]
    lens, pose = (at.stop - at.start for at in (layout.lens[number], layout.pose[number]))
    moves = np.zeros((len(T_world_target), lens + POSE + 1, lens + pose + POSE + 1))
    moves[:, :lens, :lens] = np.eye(lens)
    turn, shift = slice(lens, lens + 3), slice(lens + 3, lens + POSE)
    if pose:
        # The camera's world turns about the camera, which is this far from the target's origin.
        x, y, z = R_cam_world @ T_world_target[:, :3, 3].T
        o = np.zeros_like(x)
        moves[:, turn, turn] = moves[:, shift, shift] = np.eye(3)
        moves[:, shift, turn] = np.array([[o, z, -y], [-z, o, x], [y, -x, o]]).transpose(2, 0, 1)
    moves[:, turn, lens + pose : lens + pose + 3] = R_cam_world
    moves[:, shift, lens + pose + 3 : lens + pose + POSE] = R_cam_world
    moves[:, -1, -1] = 1.0
    return moves


def _add(blocks: Blocks, own: slice, seen: np.ndarray, squares: Float64[np.ndarray, "n m m"]) -> None:
    """Add the normal equations of one camera's pictures, of the views `seen`."""
    width = own.stop - own.start
    pose = slice(width, width + POSE)
    summed = squares.sum(axis=0)
    blocks.shared[own, own] += summed[:width, :width]
    blocks.gradient.shared[own] += summed[:width, -1]
    blocks.cross[seen, own] += squares[:, :width, pose]
    blocks.view[seen] += squares[:, pose, pose]
    blocks.gradient.view[seen] += squares[:, pose, -1]
