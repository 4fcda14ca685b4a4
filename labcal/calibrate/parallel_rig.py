"""Cameras with parallel rays in a rig: which of two mirror images each view shows, and how deep it lies.

One such camera tells a flat target's tilt but for its sign, and no depth. Another camera that looks from
elsewhere sees both: of the two poses of a view those are right with which the cameras stand to each other in
all views alike. What is left, where all cameras have parallel rays, is the mirror image of the whole rig with
all its targets, which no picture tells from the rig itself.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Matrix3, Pose
from labcal.calibrate.rig_start import SharedViews, SingleCamera
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.geometry.parallel_pose import mirrored
from labcal.geometry.poses import nearest_rotation

_CANDIDATES = 100


def parallel_notes(rig: Rig, *, started: bool) -> list[str]:
    """Return what no picture tells of cameras with parallel rays, for people.

    Parameters
    ----------
    rig : Rig
    started : bool
        Whether a rig to start from said where cameras stand.
    """
    cameras = {name: rig.camera(name) for name in rig.cameras}
    parallel = [name for name, camera in cameras.items() if camera.model.parallel]
    if not parallel:
        return []
    constrained = (
        f"{', '.join(parallel)}: parallel rays determine no depth and no principal point: datum constraints "
        "fix them, with a standard deviation of 0; that the views of several cameras agree was not tested"
    )
    notes = [constrained]
    if len(cameras) == 1:
        notes.append(
            f"{parallel[0]} alone does not determine to which side the target was tilted: of each view's two "
            "poses one was taken"
        )
    elif len(parallel) == len(cameras) and not started:
        notes.append(
            "the mirror image of this rig explains the dots as well: the one was taken in which "
            f"{list(cameras)[1]} looks from the right of {parallel[0]}, or from below it. If that is wrong, "
            "depths have the wrong sign: name the cameras in the other order, or give `start`"
        )
    return notes


def with_determined_poses(cameras: Sequence[SingleCamera], start: Rig | None) -> list[SingleCamera]:
    """Return cameras whose poses of the target agree, as far as parallel rays left them open.

    Parameters
    ----------
    cameras : sequence of SingleCamera
    start : Rig or None
        Where cameras stand, more or less, if that is known.
    """
    result = list(cameras)
    if not any(one.camera.model.parallel for one in result):
        return result
    settled = {number: np.zeros(0, dtype=np.int64) for number in range(len(result))}
    for number, one in enumerate(result):
        if not one.camera.model.parallel:
            settled[number] = one.views
    placed = {0}
    while len(placed) < len(result):
        pairs = [(old, new) for old in placed for new in range(len(result)) if new not in placed]
        old, new = max(
            pairs, key=lambda pair: len(np.intersect1d(result[pair[0]].views, result[pair[1]].views))
        )
        placed.add(new)
        shared = SharedViews.of(result[old], result[new])
        if len(shared.views) == 0:
            continue  # which the rig's start refuses
        known = np.isin(shared.views, settled[old])
        wanted = None
        if start is not None and {result[old].name, result[new].name} <= set(start.cameras):
            wanted = _rotation(start.camera(result[new].name)) @ _rotation(start.camera(result[old].name)).T
        pair = (result[old].camera, result[new].camera)
        first, second = _deep(pair, *_unmirrored(pair, shared, known, wanted), known)
        result[old], result[new] = _with(result[old], shared, first), _with(result[new], shared, second)
        settled[old] = np.union1d(settled[old], shared.views)
        settled[new] = np.union1d(settled[new], shared.views)
    return result


def _rotation(camera: Camera) -> Matrix3:
    return np.asarray(camera.T_cam_world[:3, :3])


def _with(one: SingleCamera, shared: SharedViews, poses: Float64[np.ndarray, "n 4 4"]) -> SingleCamera:
    """Return a camera with other poses of the target in shared views."""
    T_cam_target = one.T_cam_target.copy()
    T_cam_target[np.searchsorted(one.views, shared.views)] = poses
    return replace(one, T_cam_target=T_cam_target)


def _unmirrored(
    pair: tuple[Camera, Camera], shared: SharedViews, known: np.ndarray, wanted: Matrix3 | None
) -> tuple[Float64[np.ndarray, "n 4 4"], Float64[np.ndarray, "n 4 4"]]:
    """Return the poses of the target in both cameras with which these stand alike in all views."""
    options: list[list[tuple[Pose, Pose]]] = []
    for T_first, T_second, is_known in zip(shared.first, shared.second, known, strict=True):
        of_first = [T_first] if is_known else [T_first, mirrored(T_first)]
        of_second = [T_second, mirrored(T_second)] if pair[1].model.parallel else [T_second]
        options.append(list(product(of_first, of_second)))
    turns = [np.array([second[:3, :3] @ first[:3, :3].T for first, second in one]) for one in options]
    candidates = np.concatenate(turns)[:_CANDIDATES]

    def alike(R: Matrix3) -> float:
        return float(
            np.median([np.einsum("kij,ij->k", one, R).max() for one in turns])
        )  # grows as angles fall

    best = candidates[int(np.argmax([alike(R) for R in candidates]))]
    if all(camera.model.parallel for camera in pair) and not known.any():
        mirror = np.diag([1.0, 1.0, -1.0])
        best = _of_two(best, mirror @ best @ mirror, wanted)
    chosen = [
        one[int(np.argmax(np.einsum("kij,ij->k", R, best)))] for one, R in zip(options, turns, strict=True)
    ]
    return np.stack([first for first, _ in chosen]), np.stack([second for _, second in chosen])


def _of_two(R: Matrix3, mirror_image: Matrix3, wanted: Matrix3 | None) -> Matrix3:
    """Return the rotation that is wanted, else that with which the second looks from the right or below."""
    if wanted is not None:
        return R if np.sum(R * wanted) >= np.sum(mirror_image * wanted) else mirror_image
    aside = R[2, :2]  # where the second looks to, along the first one's x and y
    return R if aside[int(np.argmax(np.abs(aside)))] <= 0.0 else mirror_image


def _deep(
    pair: tuple[Camera, Camera],
    first: Float64[np.ndarray, "n 4 4"],
    second: Float64[np.ndarray, "n 4 4"],
    known: np.ndarray,
) -> tuple[Float64[np.ndarray, "n 4 4"], Float64[np.ndarray, "n 4 4"]]:
    """Return the poses with depths that agree, as near to those given as what is left open allows."""
    count, rows = len(first), (2 if pair[1].model.parallel else 3)
    turns = second[:, :3, :3] @ first[:, :3, :3].transpose(0, 2, 1)
    R, _ = nearest_rotation(turns.sum(axis=0))
    A, b = np.zeros((count, rows, 3 + count)), np.zeros((count, rows))
    shift = np.median(second[:, :3, 3] - first[:, :3, 3] @ R.T, axis=0)
    for view in range(count):
        A[view, :, :3] = np.eye(3)[:rows]
        A[view, :, 3 + view] = 0.0 if known[view] else R[:rows, 2]
        b[view] = (second[view, :3, 3] - R @ first[view, :3, 3] - shift)[:rows]
    found, *_ = np.linalg.lstsq(A.reshape(-1, 3 + count), b.ravel(), rcond=1e-9)
    first, second = first.copy(), second.copy()
    first[:, 2, 3] += np.where(known, 0.0, found[3:])
    if pair[1].model.parallel:
        second[:, 2, 3] = (first[:, :3, 3] @ R.T + shift + found[:3])[:, 2]
    return first, second
