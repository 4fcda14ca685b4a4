"""Comparison of one half of the views with the other: a check of a calibration that needs no truth."""

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.estimators.model import Model
from labcal.evaluate.own_lengths import LengthErrors, errors_of_lengths
from labcal.reconstruct.reconstruction import reconstruct_points
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces


def halves(detections: Detections) -> tuple[Detections, Detections]:
    """Return the views with even and with odd numbers."""
    odd = detections.view_number % 2 == 1
    return detections.where(~odd), detections.where(odd)


def disagreement(one: HandheldCalibration, other: HandheldCalibration) -> Float64[np.ndarray, " n"]:
    """Return differences of two calibrations of one rig over the standard deviations that both state.

    By camera the intrinsics, the lens's coefficients and, but for the first camera, which is the world, its
    rotation about its axes and its shift.
    """
    ratios = []
    for number, name in enumerate(one.rig.cameras):
        first, second = one.rig.camera(name), other.rig.camera(name)
        sigma, more = one.fits[name].sigma, other.fits[name].sigma
        free = len(sigma.dist)
        turn = Rotation.from_matrix(first.T_cam_world[:3, :3] @ second.T_cam_world[:3, :3].T).as_rotvec()
        shift = first.T_cam_world[:3, 3] - second.T_cam_world[:3, 3]
        intrinsics = np.subtract(first.intrinsics, second.intrinsics)
        ratios += [
            intrinsics / np.hypot(sigma.intrinsics, more.intrinsics),
            (first.dist[:free] - second.dist[:free]) / np.hypot(sigma.dist, more.dist),
        ]
        if number:
            ratios += [
                turn / np.hypot(sigma.rotation_rad, more.rotation_rad),
                shift / np.hypot(sigma.translation_mm, more.translation_mm),
            ]
    return np.concatenate(ratios)


def squared_differences(one: HandheldCalibration, other: HandheldCalibration) -> tuple[float, int]:
    """Return the squared differences of two calibrations of one rig in units of their joint covariances.

    Returns
    -------
    float, int
        The sum, which follows chi-square where both budgets hold, and its degrees of freedom.

    Raises
    ------
    InputError
        A calibration states no covariance.
    """
    if one.rig.covariance is None or other.rig.covariance is None:
        raise InputError("A calibration states no covariance. Calibrate with free lenses.")
    off: list[float] = []
    for number, name in enumerate(one.rig.cameras):
        first, second = one.rig.camera(name), other.rig.camera(name)
        off += np.subtract(first.intrinsics, second.intrinsics).tolist()
        off += (first.dist - second.dist)[: first.model.coefficients].tolist()
        if number:
            turn = first.T_cam_world[:3, :3] @ second.T_cam_world[:3, :3].T
            off += Rotation.from_matrix(turn).as_rotvec().tolist()
            off += (first.T_cam_world[:3, 3] - second.T_cam_world[:3, 3]).tolist()
    both = one.rig.covariance.matrix + other.rig.covariance.matrix
    scale = np.sqrt(np.diagonal(both))
    ratios = np.array(off) / scale
    return float(ratios @ np.linalg.solve(both / np.outer(scale, scale), ratios)), len(off)


def print_and_rig(learned: Detections, target: AnyTarget, lens: str) -> tuple[HandheldCalibration, DotPlaces]:
    """Return a rig and the places of the dots on the print, both of the same views.

    Raises
    ------
    InputError
        The views determine no rig.
    """
    found = calibrate_handheld(learned, target, lens, HandheldSettings(dot_places="freed"))
    if found.freed is None:
        raise InputError("A calibration with free dots returned none.")
    return found, found.freed.places()


def lengths_elsewhere(
    model: Rig | Model, places: DotPlaces, others: Detections, target: AnyTarget
) -> LengthErrors:
    """Return the errors of distances on a print that was measured in other views.

    Parameters
    ----------
    model : Rig or Model
        What reconstructs.
    places : DotPlaces
        Of the dots on the print.
    others : Detections
        Of the views in which distances are measured: those of all pairs of dots, near and far.
    target : AnyTarget

    Raises
    ------
    InputError
        No dot of the print is in the others.
    """
    return errors_of_lengths(reconstruct_points(model, others, target), places)
