"""Exchanged pictures, found by known cameras: their rays meet when the pictures are exchanged back."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from labcal.calibrate.agreement.exchange.decision import exchanges, refuse_exchanged
from labcal.calibrate.triangulation_residuals import MOST_PX, TriangulationResiduals
from labcal.cameras.camera import Camera
from labcal.correspond.matching import Matches


def refuse_exchanged_by_rays(cameras: Sequence[Camera], matches: Matches) -> None:
    """Raise where, seen by known cameras, pictures of a view are exchanged.

    Parameters
    ----------
    cameras : sequence of Camera
        In the order of the matches.
    matches : Matches

    Raises
    ------
    ExchangedPicturesError
        In a view, the rays of the dots meet far better when two cameras' pictures are exchanged.
    """
    residuals_px = TriangulationResiduals.of(cameras, matches).px
    for view, rows in matches.rows_by_view.items():
        given = float(np.median(residuals_px[rows]))
        if given <= MOST_PX:
            continue
        of_view = matches.where(rows)
        for (a, b), order in exchanges(len(cameras)):
            exchanged = replace(of_view, q=of_view.q[:, order], covariance=of_view.covariance[:, order])
            left = TriangulationResiduals.of(cameras, exchanged).typical_px
            refuse_exchanged(view, (matches.cameras[a], matches.cameras[b]), given, left, MOST_PX)
