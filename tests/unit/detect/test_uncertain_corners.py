"""Corners whose fit has converged, but whose pixels hardly tell their place: not measured."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.boards.april_grid_picture import april_grid_picture
from labcal.bench.boards.chessboard_picture import chessboard_picture
from labcal.detect.corners.corner_fit import SettledCorner
from labcal.detect.corners.corners import Corners
from labcal.detect.corners.hard_edges import edge_normals
from labcal.detect.corners.picture_corners import picture_corners
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.settings import DetectSettings


def settled_corners(monkeypatch: pytest.MonkeyPatch) -> tuple[Corners, np.ndarray]:
    """Return the corners of a drawn chessboard as its fits have left them, and the picture."""
    found: list[tuple[Corners, np.ndarray]] = []

    def kept(
        corners: Corners, grey: np.ndarray, refusal: Refusal | None, settings: DetectSettings
    ) -> PictureDots:
        found.append((corners, grey))
        return picture_corners(corners, grey, refusal, settings)

    monkeypatch.setattr("labcal.detect.chessboard.picture_corners", kept)
    view = chessboard_picture(0, 3)
    assert detect_dots(view.picture, view.board).indexed
    return found[-1]


def beside_an_edge(fit: SettledCorner, blurs: float) -> SettledCorner:
    """Return a fit that has seen no pixel within some blurs of one of its edges."""
    window = fit.window
    away = np.abs(edge_normals(fit)[0] @ (window.offset - fit.state[:2, None]))
    seen = away > blurs * fit.state[4]
    mask = window.mask.copy()
    mask[mask] = seen
    pixels = replace(window, mask=mask, offset=window.offset[:, seen], value=window.value[seen])
    return replace(fit, pixels=pixels)


def test_a_corner_of_which_little_is_seen_is_not_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    corners, grey = settled_corners(monkeypatch)
    number = len(corners.fits) // 2
    whole = picture_corners(corners, grey, None, DetectSettings())
    fit = corners.fits[number]
    assert fit is not None
    fits: list[SettledCorner | None] = list(corners.fits)
    fits[number] = beside_an_edge(fit, 2.5)
    thinned = replace(corners, fits=fits)
    dots = picture_corners(thinned, grey, None, DetectSettings())
    (at,) = np.flatnonzero((whole.index == corners.index[number]).all(axis=1))
    assert whole.flag[at] is DotFlag.OK
    assert dots.flag[at] is DotFlag.BAD_FIT
    assert np.isnan(dots.position[at]).all()
    assert dots.ok.sum() == whole.ok.sum() - 1

    # Error in the width of an edge, and in what is usual: either alone refuses it.
    free = DetectSettings().model_copy(
        update={"corner": DetectSettings().corner.model_copy(update={"max_error_blurs": 5.0})}
    )
    assert picture_corners(thinned, grey, None, free).flag[at] is DotFlag.BAD_FIT
    free = free.model_copy(update={"corner": free.corner.model_copy(update={"max_error_factor": 1000.0})})
    kept = picture_corners(thinned, grey, None, free)
    assert kept.flag[at] is DotFlag.OK
    error = np.sqrt(np.linalg.eigvalsh(kept.covariance)[:, 1])
    assert error[at] > 10.0 * np.median(error)


def test_no_corner_of_a_grid_is_off_by_a_quarter_of_a_blur() -> None:
    """Of this grid a tag's corner converged 2.5 px from its place, and stated an error of 2.5 px."""
    view = april_grid_picture(10, 515)
    dots = detect_dots(view.picture, view.board)
    assert dots.indexed
    number = dots.index[dots.ok] @ [1, view.board.cols]
    off = np.linalg.norm(dots.position[dots.ok] - view.corner[number], axis=1)
    assert off.max() < 0.25
