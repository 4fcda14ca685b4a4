"""The truth of a rendered shoot, in a folder that the measuring arm never reads."""

from dataclasses import dataclass
from itertools import islice
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from labcal.arrays import Mask, Pixels, Vectors3
from labcal.bounds import MOST_INDEX, MOST_MM
from labcal.cameras.record import CameraRecord, Matrix3Record, PoseRecord
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import checked_rig
from labcal.paths import AnyPath, as_path
from labcal.run.documents import read_document
from labcal.run.made import make_folder
from labcal.run.names import Name, is_name
from labcal.run.outputs import write_file
from labcal.run.table_columns import TableLines, table_parts
from labcal.run.tables import refuse_twice, table_text

FOLDER = "truth"
HEADER = (
    "view", "camera", "col", "row", "X_mm", "Y_mm", "Z_mm",
    "centre_x_px", "centre_y_px", "centroid_x_px", "centroid_y_px", "visible",
)  # fmt: skip


class TruePicture(BaseModel):
    """True values of one picture that differ from those of its view; else null."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    taken_by: Name | None = None
    """The camera that really took it."""
    T_cam_world: PoseRecord | None = None
    """Pose of that camera."""
    T_world_target: PoseRecord | None = None
    """Pose of the target."""
    K: Matrix3Record | None = None
    """Camera matrix, px, of a lens that was refocused."""


class TrueView(BaseModel):
    """The true pose of the target in one view; with motion, in the middle of the frame."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    T_world_target: PoseRecord
    """Transform from the target to the world, mm."""
    cameras: dict[Name, TruePicture] = {}
    """By the delivered name of a picture; only pictures with other values."""


class Truth(BaseModel):
    """``truth.json``: the cameras and poses that made the pictures."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-truth"] = "labcal-truth"
    """Kind of the file."""
    format_version: Literal[1] = 1
    """Version of the form of the file."""
    cameras: Annotated[dict[Name, CameraRecord], Field(min_length=1)]
    """True cameras by name."""
    views: dict[Name, TrueView]
    """True poses by the name of the view."""
    mistake: str | None = None
    """Name of the mistake that was made on purpose."""
    mistake_description: str | None = None
    """Description of the mistake."""
    mistake_views: tuple[Name, ...] = ()
    """Views that the mistake concerns."""


@dataclass(frozen=True)
class TrueDots:
    """Every dot of the target in one picture; NaN where it cannot be projected."""

    view: str
    camera: str
    index: np.ndarray
    """(n, 2) integer, (col, row)."""
    point: Vectors3
    """(n, 3), world, mm."""
    centre: Pixels
    """(n, 2), the image of the dot's centre."""
    centroid: Pixels
    """(n, 2), the centre of area of the image of its outer outline."""
    visible: Mask
    """(n,), the whole outline is in the frame and nothing hides it."""


def write_truth(folder: AnyPath, truth: Truth, dots: list[TrueDots]) -> None:
    """Write ``truth/truth.json`` and ``truth/dots.csv`` into a shoot under construction."""
    folder = as_path(folder)
    home = folder / FOLDER
    make_folder(home)
    write_file(home / "truth.json", truth.model_dump_json(indent=2) + "\n", force=True)
    lines: list[list[object]] = []
    for picture in dots:
        figures = np.concatenate([picture.point, picture.centre, picture.centroid], axis=1)
        lines += [
            [picture.view, picture.camera, *index, *values, int(visible)]
            for index, values, visible in zip(
                picture.index.tolist(), figures.tolist(), picture.visible, strict=True
            )
        ]
    write_file(home / "dots.csv", table_text(HEADER, lines), force=True)


def has_truth(folder: AnyPath) -> bool:
    """Return whether the folder of the shoot contains its truth."""
    folder = as_path(folder)
    return (folder / FOLDER / "truth.json").is_file()


def read_truth(folder: AnyPath) -> Truth:
    """Read ``truth.json`` of a shoot.

    Raises
    ------
    InputError
        It is missing, or not one that this version reads.
    """
    folder = as_path(folder)
    path = folder / FOLDER / "truth.json"
    truth = read_document(Truth, "truth", path)
    checked_rig(Rig(cameras=truth.cameras), str(path))
    return truth


def read_true_dots(folder: AnyPath) -> list[TrueDots]:
    """Read ``dots.csv`` of a shoot, one entry a picture, in the file's order.

    Raises
    ------
    InputError
        It is missing, its columns are not those of this version, a line is damaged, or a dot is there twice.
    """
    folder = as_path(folder)
    path = folder / FOLDER / "dots.csv"
    pictures: dict[tuple[str, str], int] = {}
    read = [_columns(part, pictures) for part in table_parts(HEADER, "true dots", path)]
    if not read:
        return []
    picture, table = (np.concatenate(column) for column in zip(*read, strict=True))
    refuse_twice(path, np.column_stack([picture, table[:, :2].astype(np.int64)]), "dot of a picture")
    order = np.argsort(picture, kind="stable")
    rows = np.split(order, np.searchsorted(picture[order], np.arange(1, len(pictures))))
    return [
        TrueDots(
            view=view,
            camera=camera,
            index=table[lines, :2].astype(np.int64),
            point=table[lines, 2:5],
            centre=table[lines, 5:7],
            centroid=table[lines, 7:9],
            visible=table[lines, 9] != 0.0,
        )
        for (view, camera), lines in zip(pictures, rows, strict=True)
    ]


def _columns(part: TableLines, pictures: dict[tuple[str, str], int]) -> tuple[np.ndarray, np.ndarray]:
    """Return the index of the picture and the values of lines; raise at a damaged line."""
    known = len(pictures)
    names = zip(part.column("view"), part.column("camera"), strict=True)
    picture = np.array([pictures.setdefault(name, len(pictures)) for name in names], dtype=np.int64)
    bad = [
        number
        for number, name in enumerate(islice(pictures, known, None), known)
        if not all(map(is_name, name))
    ]
    table = part.figures(HEADER[2:])
    index, place, images, visible = np.split(table, (2, 5, 9), axis=1)
    whole = (index == np.floor(index)) & (index >= 0) & (index <= MOST_INDEX)
    part.require(~np.isin(picture, bad), "names have letters, digits and hyphens only")
    part.require(whole.all(axis=1), f"col and row are whole numbers of 0 to {MOST_INDEX}")
    part.require((np.abs(place) <= MOST_MM).all(axis=1), f"coordinates are at most {MOST_MM:g} mm")
    part.require(~np.isinf(images).any(axis=1), "pixels are numbers, or nan")
    part.require(np.isin(visible[:, 0], (0.0, 1.0)), "visible is 0 or 1")
    part.refuse()
    return picture, table
