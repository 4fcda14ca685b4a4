"""The truth of a rendered shoot, in a folder of its own that the measuring arm never opens."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from labcal.arrays import Mask, Pixels, Points
from labcal.cameras.record import CameraRecord, Matrix4Record
from labcal.run.documents import read_document
from labcal.run.made import make_folder
from labcal.run.names import Name
from labcal.run.outputs import write_file
from labcal.run.tables import damaged_line, read_table, table_text

FOLDER = "truth"
HEADER = (
    "view", "camera", "col", "row", "X_mm", "Y_mm", "Z_mm",
    "centre_x_px", "centre_y_px", "centroid_x_px", "centroid_y_px", "visible",
)  # fmt: skip


class TruePicture(BaseModel):
    """What is true of one picture alone, where that differs from the rest; else null."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    taken_by: Name | None = None
    """The camera that really took it."""
    T_cam_world: Matrix4Record | None = None
    """Where that camera was."""
    T_world_target: Matrix4Record | None = None
    """Where the target was."""


class TrueView(BaseModel):
    """Where the target truly was in one view; with motion, in the middle of the frame."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    T_world_target: Matrix4Record
    cameras: dict[Name, TruePicture] = {}
    """By the name under which a picture is delivered; only pictures of which something else is true."""


class Truth(BaseModel):
    """``truth.json``: the cameras and poses that made the pictures."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-truth"] = "labcal-truth"
    format_version: Literal[1] = 1
    cameras: Annotated[dict[Name, CameraRecord], Field(min_length=1)]
    views: dict[Name, TrueView]
    mistake: str | None = None
    """Name of the mistake that was made on purpose."""
    mistake_description: str | None = None
    """What is not as it was meant."""
    mistake_views: tuple[Name, ...] = ()
    """Views in which it is not."""


@dataclass(frozen=True)
class TrueDots:
    """Every dot of the target in one picture; NaN where it cannot be projected."""

    view: str
    camera: str
    index: np.ndarray
    """(n, 2) integer, (col, row)."""
    point: Points
    """(n, 3), world, mm."""
    centre: Pixels
    """(n, 2), the image of the dot's centre."""
    centroid: Pixels
    """(n, 2), the centre of area of the image of its outer outline."""
    visible: Mask
    """(n,), the whole outline is in the frame and nothing hides it."""


def write_truth(folder: Path, truth: Truth, dots: list[TrueDots]) -> None:
    """Write ``truth/truth.json`` and ``truth/dots.csv`` into a shoot under construction."""
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


def has_truth(folder: Path) -> bool:
    """Return whether the shoot has its truth beside it."""
    return (folder / FOLDER / "truth.json").is_file()


def read_truth(folder: Path) -> Truth:
    """Read ``truth.json`` of a shoot.

    Raises
    ------
    InputError
        It is missing, or not one that this version reads.
    """
    return read_document(Truth, "truth", folder / FOLDER / "truth.json")


def read_true_dots(folder: Path) -> list[TrueDots]:
    """Read ``dots.csv`` of a shoot, one entry a picture, in the file's order.

    Raises
    ------
    InputError
        It is missing, or its columns are not those of this version.
    """
    path = folder / FOLDER / "dots.csv"
    pictures: dict[tuple[str, str], list[list[float]]] = {}
    for number, line in enumerate(read_table(HEADER, "true dots", path)):
        try:
            view, camera, *figures = line
            _, _, _, _, _, _, _, _, _, _ = row = [float(figure) for figure in figures]
        except ValueError as error:
            raise damaged_line(path, number, line) from error
        pictures.setdefault((view, camera), []).append(row)
    dots = []
    for (view, camera), rows in pictures.items():
        table = np.array(rows, dtype=np.float64)
        dots.append(
            TrueDots(
                view=view,
                camera=camera,
                index=table[:, :2].astype(np.int64),
                point=table[:, 2:5],
                centre=table[:, 5:7],
                centroid=table[:, 7:9],
                visible=table[:, 9] != 0.0,
            )
        )
    return dots
