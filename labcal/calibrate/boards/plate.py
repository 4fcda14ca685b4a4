"""Cameras calibrated alone from boards on a plate, and first places of all of them."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.calibrate.agreeing_views import SingleCameras, of_agreeing_views
from labcal.calibrate.boards.sightings import Sightings, placed_boards
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.rig_start import SingleCamera
from labcal.calibrate.single_calibration import HandheldSettings, SingleCalibration, calibrate_single
from labcal.calibrate.usable_dots import in_full_pictures
from labcal.calibrate.view_agreement import InconsistentPicture, contradictions
from labcal.correspond.boards_table import by_board
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.poses import inverse
from labcal.targets.board_set import BoardSet

_MOST_INCONSISTENT = 0.2
"""Share of a camera's pictures that may contradict others and be left out; more say that none is right."""


@dataclass(frozen=True)
class Plate:
    """Boards on a plate and the cameras that saw them.

    Attributes
    ----------
    cameras : list of SingleCalibration
        Each calibrated alone with every board of a view by itself; its poses are those of the plate.
    entering : Detections
        The dots that enter, with the plate's views.
    boards : BoardSet
        At places that are known, or first values of them.
    open_places : bool
        Whether the places of boards are to be found.
    left_out : tuple of str
        Pictures that do not enter, and why, for people.
    """

    cameras: list[SingleCalibration]
    entering: Detections
    boards: BoardSet
    open_places: bool
    left_out: tuple[str, ...]

    @property
    def views(self) -> tuple[str, ...]:
        """Names of the plate's views."""
        return self.entering.views

    def contradictory(self) -> list[InconsistentPicture]:
        """Return the pictures of views in which cameras disagree on the plate, unless these are too many."""
        if len(self.cameras) == 1:
            return []
        wrong = contradictions([one.single for one in self.cameras], self.boards.points())
        for camera in self.cameras:
            out = sum(one.camera == camera.name for one in wrong)
            if out > max(1, int(_MOST_INCONSISTENT * len(camera.single.views))):
                return []
        return wrong


def plate_of(
    usable: Detections, cameras: tuple[str, ...], boards: BoardSet, how: tuple[str, HandheldSettings]
) -> Plate:
    """Calibrate cameras alone, and place boards and cameras.

    Parameters
    ----------
    usable : Detections
        Numbered as dots of the set.
    cameras : tuple of str
        In their order; the first is the world.
    boards : BoardSet
    how : (str, HandheldSettings)
        The lens model, and the settings.

    Raises
    ------
    InputError
        A camera has too few views of boards, its dots determine no camera, or the views do not link all.
    """
    lens, settings = how
    settings = replace(settings, dot_places=DotTreatment.DECLARED)
    flat = boards.model_copy(update={"places": None})
    numbers = boards.board_number[usable.index[:, 0]]
    split = by_board(usable, np.array(boards.names)[numbers])
    of_split = _views_of(split, usable, numbers)
    full, reasons = in_full_pictures(split)

    def again(name: str, dots: Detections) -> SingleCalibration:
        return calibrate_single(name, dots, flat, lens, settings)

    alone: list[SingleCalibration] = []
    for name in cameras:
        mine = full.where(full.camera == name)
        one = SingleCameras([again(name, mine)], mine, ())
        agreeing = of_agreeing_views(one, flat, again, free_dots=False)
        alone, reasons = [*alone, *agreeing.cameras], (*reasons, *agreeing.left_out)
    entered = {(one.name, view) for one in alone for view in one.dots.views}
    pictures = zip(split.camera.tolist(), split.view.tolist(), strict=True)
    entering = usable.where(np.array([picture in entered for picture in pictures], dtype=bool))
    seen = _sightings(alone, of_split, flat, entering.views)
    if boards.places is None:
        placed = placed_boards(seen, cameras, boards.names).boards
        on_plate = boards.placed(np.stack([placed[number] for number in range(len(boards.targets))]))
    else:
        on_plate = boards
    merged = [_of_plate(one, number, seen, on_plate, entering) for number, one in enumerate(alone)]
    return Plate(merged, entering, on_plate, boards.places is None, reasons)


def _views_of(split: Detections, whole: Detections, board: np.ndarray) -> dict[str, tuple[str, int]]:
    """Return the plate's view and the board's number of each view of a board by itself.

    Raises
    ------
    InputError
        Two of them have the same name.
    """
    found: dict[str, tuple[str, int]] = {}
    for name, view, number in zip(split.view.tolist(), whole.view.tolist(), board.tolist(), strict=True):
        if found.setdefault(name, (view, number)) != (view, number):
            raise InputError(
                f"The views '{found[name][0]}' and '{view}' with their boards would both be called '{name}'. "
                "Rename the pictures of one of them."
            )
    return found


def _sightings(
    alone: list[SingleCalibration],
    of_split: dict[str, tuple[str, int]],
    boards: BoardSet,
    views: tuple[str, ...],
) -> Sightings:
    """Return the poses of all boards in all pictures."""
    rows: list[tuple[int, int, int, int]] = []
    poses = []
    for number, one in enumerate(alone):
        counts = np.bincount(one.dots.view_number, minlength=len(one.dots.views))
        for at, name in enumerate(one.dots.views):
            view, board = of_split[name]
            rows.append((number, views.index(view), board, int(counts[at])))
            poses.append(one.single.T_cam_target[at] @ boards.poses[board])
    camera, view_number, board_number, dots = np.array(rows, dtype=np.int64).T
    return Sightings(camera, view_number, board_number, dots, np.stack(poses))


def _of_plate(
    one: SingleCalibration, number: int, seen: Sightings, boards: BoardSet, entering: Detections
) -> SingleCalibration:
    """Return a camera with its poses of the plate, each by the board with most dots."""
    best: dict[int, int] = {}
    mine = np.flatnonzero(seen.camera == number)
    for k in mine[np.argsort(seen.dots[mine], kind="stable")]:  # the last one stays
        best[int(seen.view[k])] = int(k)
    views = np.array(sorted(best), dtype=np.int64)
    T = np.stack(
        [
            seen.T_cam_board[best[view]] @ inverse(boards.poses[seen.board[best[view]]])
            for view in views.tolist()
        ]
    )
    dots = entering.where(entering.camera == one.name)
    return replace(one, dots=dots, single=SingleCamera(one.name, one.single.camera, views, T))
