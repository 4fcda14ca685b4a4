"""All corners of a chessboard that can be measured, from those that are known roughly."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int

from labcal.arrays import Pixels
from labcal.detect.corners.corner_fit import SettledCorner, fit_corners, places_of
from labcal.detect.corners.corner_window import Places, WindowLimits
from labcal.detect.corners.wider_fits import wider_fits
from labcal.detect.grey import GreyPicture, clipping
from labcal.detect.lattice.lattice import Lattice, Node
from labcal.detect.lattice.prediction import Prediction, Predictor
from labcal.detect.medians import median_of
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.detect.stage_settings.grid import GridSettings
from labcal.geometry.projective_map import projective_map
from labcal.targets.square_board import SquareBoard

_FEWEST = 4  # corners, not on a line: what a homography takes
_ALL_NEAR = 24
"""Most neighbours by which a corner is predicted: within two nodes to either side."""


@dataclass(frozen=True)
class Corners:
    """Corners of a board in a picture.

    Attributes
    ----------
    index : ndarray of int, shape (n, 2)
        (col, row).
    seen_at : ndarray, shape (n, 2)
        Where they are, px: as fitted, or roughly.
    fits : list of SettledCorner or None, length n
        Their fits; None where a corner is not measured.
    axes : ndarray, shape (n, 2, 2), or None
        Columns: one square along x and y at every corner, px; None where that is to be found from the
        corners.
    """

    index: Int[np.ndarray, "n 2"]
    seen_at: Pixels
    fits: list[SettledCorner | None]
    axes: Float64[np.ndarray, "n 2 2"] | None = None

    @classmethod
    def none(cls) -> "Corners":
        """Return no corners."""
        return cls(np.zeros((0, 2), dtype=np.int64), np.zeros((0, 2)), [])

    def select(self, which: Int[np.ndarray, " m"]) -> "Corners":
        """Return some of the corners, by number."""
        return Corners(self.index[which], self.seen_at[which], [self.fits[k] for k in which])

    def spans_a_plane(self) -> bool:
        """Tell whether there are corners enough for a homography, and not all on one line."""
        return spans_a_plane(self.index)


def spans_a_plane(index: Int[np.ndarray, "n 2"]) -> bool:
    """Tell whether corners, by (col, row), are enough for a homography, and not all on one line."""
    if len(index) < _FEWEST:
        return False
    away = index - index[0]
    farthest = away[np.abs(away).sum(axis=1).argmax()]
    return bool((away[:, 0] * farthest[1] != away[:, 1] * farthest[0]).any())


@dataclass(frozen=True)
class Standard:
    """The usual roughness and step of a picture's corners, which a fit is compared with."""

    roughness: float
    step: float

    @classmethod
    def of(cls, fits: list[SettledCorner | None]) -> "Standard":
        """Return the medians."""
        sound = [fit for fit in fits if fit is not None]
        return cls(
            median_of(np.array([fit.roughness for fit in sound] or [0.0])),
            median_of(np.array([fit.step for fit in sound] or [0.0])),
        )

    def met_by(self, fit: SettledCorner | None, settings: CornerSettings) -> SettledCorner | None:
        """Return the fit if it is about as good as the others."""
        if fit is None or fit.step < settings.min_step_share * self.step:
            return None
        roughest = settings.roughness_factor * self.roughness + settings.roughness_share
        return fit if fit.roughness < roughest else None


def measured_corners(
    grey: GreyPicture, board: SquareBoard, rough: Corners, settings: DetectSettings
) -> Corners:
    """Fit the corners that are known roughly, and those of the board beside them that can be found.

    A corner whose markers were not recognised, or from whose rough place no fit finds it, is looked for where
    its neighbours predict it; there it must be one, of the right colours, within a tenth of a square.
    """
    if not rough.spans_a_plane():
        return rough
    search = _Search.of(grey, board, settings.corner)
    axes_all = _axes(rough) if rough.axes is None else rough.axes
    fits = fit_corners(grey, search.places(rough.index, rough.seen_at, axes_all), settings.corner)
    standard = Standard.of(fits)
    fits = [standard.met_by(fit, settings.corner) for fit in fits]
    index = [(int(i), int(j)) for i, j in rough.index]
    seen_at = list(places_of(fits, rough.seen_at))
    numbers = {node: k for k, node in enumerate(index)}
    known = {node: k for node, k in numbers.items() if fits[k] is not None}
    tried: dict[Node, int] = {}
    found = bool(known)  # from none there is nothing to predict
    while found:
        found = False
        beside = _beside(known, board)
        if all(tried.get(node, 0) >= _ALL_NEAR for node in beside):
            break
        predictor = Predictor(
            Lattice(dict(known)), _as_outlines(seen_at), _predicting(len(known), settings.grid)
        )
        expected = predictor.predict(beside)
        new = {node: one for node, one in expected.items() if tried.get(node, 0) < one.neighbours}
        tried |= {node: one.neighbours for node, one in new.items()}
        for node, fit in zip(new, search.fits_at(new), strict=True):
            if fit is None or standard.met_by(fit, settings.corner) is None:
                continue
            known[node] = number = numbers.setdefault(node, len(index))
            if number == len(index):
                index.append(node)
                fits.append(fit)
                seen_at.append(fit.centre)
            fits[number], seen_at[number] = fit, fit.centre
            found = True
    return Corners(np.array(index, dtype=np.int64), np.array(seen_at), fits)


def widened_corners(
    grey: GreyPicture, board: SquareBoard, corners: Corners, settings: CornerSettings
) -> Corners:
    """Return corners with their fits over all of their edges, those that are as good as the others.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    board : SquareBoard
    corners : Corners
        As of :func:`measured_corners`.
    settings : CornerSettings
    """
    nodes = [(i, j) for i, j in corners.index.tolist()]
    fits = {node: fit for node, fit in zip(nodes, corners.fits, strict=True) if fit is not None}
    if not corners.spans_a_plane() or not fits:
        return corners
    fitted = np.flatnonzero([fit is not None for fit in corners.fits])
    no_axes = np.full((len(fitted), 2, 2), np.nan)
    places = _Search.of(grey, board, settings).places(corners.index[fitted], corners.seen_at[fitted], no_axes)
    wider = wider_fits(grey, fits, places, lambda: _axes(corners)[fitted], settings)
    standard = Standard.of(list(wider.values()))
    found = [standard.met_by(wider.get(node), settings) for node in nodes]
    return Corners(corners.index, places_of(found, corners.seen_at), found)


def _predicting(known: int, settings: GridSettings) -> GridSettings:
    """Return the settings of predictions, of which four corners, if there are no more, give some."""
    if known > _FEWEST:
        return settings
    return settings.model_copy(update={"min_near_nodes": min(_FEWEST, settings.min_near_nodes)})


def _as_outlines(places: list[np.ndarray]) -> Outlines:
    """Return corners as the spots that a grid is made of."""
    count = len(places)
    shape = np.tile(np.eye(2), (count, 1, 1))
    return Outlines(np.array(places), shape, np.zeros(count), np.zeros(count))


def _beside(known: dict[Node, int], board: SquareBoard) -> list[Node]:
    """Return the board's nodes that are not known, but next to known ones."""
    near = {(a + i, b + j) for a, b in known for i in (-1, 0, 1) for j in (-1, 0, 1)} - known.keys()
    return sorted(node for node in near if 0 <= node[0] < board.cols and 0 <= node[1] < board.rows)


@dataclass(frozen=True)
class _Search:
    """The picture of a board in which corners are looked for."""

    grey: GreyPicture
    board: SquareBoard
    settings: CornerSettings
    black: np.ndarray
    """Black squares, by the corner to whose upper right they lie, shape (cols, rows)."""
    most: float
    """Grey value from which on the picture is clipped."""

    @classmethod
    def of(cls, grey: GreyPicture, board: SquareBoard, settings: CornerSettings) -> "_Search":
        """Return the search in a picture."""
        i, j = np.indices((board.cols, board.rows)).reshape(2, -1) + 1
        black = board.is_black(i, j).reshape(board.cols, board.rows)
        return cls(grey, board, settings, black, clipping(grey, settings.clipped_value_share)[1])

    def fits_at(self, predictions: dict[Node, Prediction]) -> list[SettledCorner | None]:
        """Return the fits of corners where their neighbours predict them; None for those that are none."""
        if not predictions:
            return []
        index = np.array(list(predictions), dtype=np.int64)
        seen = np.array([one.position for one in predictions.values()])
        steps = np.array([one.steps for one in predictions.values()])
        fits = fit_corners(self.grey, self.places(index, seen, steps), self.settings)
        return [
            None if fit is None or one.residual(fit.centre) > self.settings.max_residual_squares else fit
            for fit, one in zip(fits, predictions.values(), strict=True)
        ]

    def places(
        self, index: Int[np.ndarray, "n 2"], seen_at: Pixels, axes: Float64[np.ndarray, "n 2 2"]
    ) -> Places:
        """Return what lies around corners of the board."""
        board, settings = self.board, self.settings
        reach = float(np.sqrt(settings.reach_bend_px * max(self.grey.shape)))
        limits = np.empty((len(index), len(WindowLimits._fields)))
        limits[:, 0] = np.where(self.black[index[:, 0], index[:, 1]], -1.0, 1.0)
        limits[:, 1] = board.corner_gap
        limits[:, 2] = [board.clear_reach(col, row) for col, row in index.tolist()]
        limits[:, 3], limits[:, 4] = max(settings.min_reach_px, reach), settings.max_reach_squares
        limits[:, 5] = self.most
        return Places(seen_at, axes, np.zeros((len(index), 2)), limits)


def _axes(corners: Corners) -> np.ndarray:
    """Return one square along x and y at every corner, px, from the homography of all; (n, 2, 2)."""
    H = projective_map("corners", corners.index.astype(np.float64), corners.seen_at)
    xyw = np.concatenate([corners.index, np.ones((len(corners.index), 1))], axis=1) @ H.T
    q, w = xyw[:, :2] / xyw[:, 2:], xyw[:, 2]
    axes: np.ndarray = (H[None, :2, :2] - q[:, :, None] * H[None, 2:, :2]) / w[:, None, None]
    return axes
