"""Judgement of the triangulation residuals of named points, by their size and by chance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from labcal.calibrate.residual_level import ResidualLevel, SeenPoints
from labcal.calibrate.systematic_residual import MOST, SystematicResidual, systematic_residual
from labcal.calibrate.triangulation_check import TriangulationCheck, scatter_of
from labcal.calibrate.triangulation_residuals import TriangulationResiduals
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.parameter_derivatives import parameter_count
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.estimators.model import Model

FEWEST = 20
"""Points from which on their median residual tells what is usual among them."""


@dataclass(frozen=True)
class Judgement:
    """The doubts about named points.

    Attributes
    ----------
    check : TriangulationCheck
        Of all views, and of single ones.
    systematic : SystematicResidual or None
        What the residuals of points that all cameras see have in common; None where it is not tested.
    outlying : list of bool array
        Single points whose residual is beyond chance, by the cameras that see them.
    """

    check: TriangulationCheck
    systematic: SystematicResidual | None
    outlying: list[Bool[np.ndarray, " n"]]


def judged(
    model: Model | Rig, groups: Sequence[SeenPoints], residuals: Sequence[TriangulationResiduals]
) -> Judgement:
    """Judge triangulation residuals.

    Parameters
    ----------
    model : Model or Rig
        A method has cameras that were resected from its training data.
    groups : sequence of SeenPoints
        All points, by the cameras that see them.
    residuals : sequence of TriangulationResiduals
        Theirs, weighed by pixels that scatter by the calibration, too.
    """
    if isinstance(model, Rig):
        cameras = tuple(model.camera(name) for name in model.cameras)
    else:
        cameras = model.resected or ()
    count = parameter_count(cameras)
    parameters, known = np.zeros((count, count)), False
    if isinstance(model, Rig) and model.covariance is not None:
        parameters, known = model.covariance.matrix, True
    scatter_px = scatter_of(model.calibration)
    if known:  # of few points, errors of the calibration may be larger than noise
        groups = [
            group if len(group.matches) >= FEWEST else group.by_itself(cameras, parameters, scatter_px)
            for group in groups
        ]
    level = ResidualLevel(cameras, parameters, scatter_px, groups)
    outlying = [group.outlying for group in groups]
    compared = [(one, group.matches) for one, group in zip(residuals, groups, strict=True)]
    check = TriangulationCheck.of_groups(compared, model.calibration, level.beyond_chance)
    if not known or check.inconsistent:
        return Judgement(check, None, outlying)
    for group in groups:
        if len(group.chosen) == len(cameras):
            rows = np.flatnonzero(~np.isin(group.matches.view, check.views))
            matches = group.matches.where(rows[:: -(-len(rows) // MOST) or 1])
            point = triangulate(cameras, matches.q, matches.covariance).point
            record = model.calibration or CalibrationRecord()
            systematic = systematic_residual(cameras, matches, point, parameters, record)
            return Judgement(check, systematic, outlying)
    return Judgement(check, None, outlying)
