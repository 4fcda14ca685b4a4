"""Detections of one's own as they are given: the folder of a shoot, or a table of dots beside it."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from itertools import chain, count
from pathlib import Path

from labcal.bench.distortion.own_detections.case import held_out_parts
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import read_detections
from labcal.correspond.interop.conversion import CORNERS
from labcal.correspond.interop.corners_vnl import read_corners
from labcal.correspond.measure import detections_of, measure_pictures
from labcal.correspond.sources import shoot_sources
from labcal.errors import InputError
from labcal.estimators.training import on_stage
from labcal.paths import AnyPath, as_path
from labcal.run.progress import Progress
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot

TABLES = ("detections.csv", "corners.vnl")
"""Tables that are read in the folder of a shoot, the first one that is there."""
_MOST_NAME = 60


@dataclass(frozen=True)
class OwnDetections:
    """Dots of a target on a stage.

    Attributes
    ----------
    name : str
        Of the folder, or of the table beside it: letters, digits and hyphens.
    shoot : Shoot
        It says where the target was in every view.
    detections : Detections or None
        None where the dots are yet to be found in the pictures.
    """

    name: str
    shoot: Shoot
    detections: Detections | None

    def measured(self, executor: Executor, progress: Progress) -> "OwnDetections":
        """Return the same with dots, which are found in the pictures where no table is given.

        Raises
        ------
        InputError
            No picture could be read at all.
        """
        if self.detections is not None:
            return self
        found = measure_pictures(shoot_sources(self.shoot), self.shoot.target, executor, progress)
        return replace(self, detections=detections_of(found))


def own_detections(paths: Sequence[AnyPath]) -> list[OwnDetections]:
    """Return detections by the paths that are given.

    Parameters
    ----------
    paths : sequence of str or os.PathLike
        Each the folder of a shoot, or a table of its dots: labcal's ``detections.csv`` or mrcal's
        ``corners.vnl``, in the folder of the shoot or naming its pictures.

    Raises
    ------
    InputError
        A file cannot be read, its shoot is not known, the target was held in the hand, or there are too few
        views to hold one out.
    """
    found: list[OwnDetections] = []
    for path in paths:
        one = _opened(Path(as_path(path)))
        if not on_stage(one.shoot):
            raise InputError(
                f"The target in {one.shoot.folder} was held in the hand, so that nobody knows where its dots "
                "were, and methods cannot be measured against it. Give views of a target on a stage."
            )
        views = [view.name for view in one.shoot.views()] if one.detections is None else one.detections.views
        held_out_parts(one.shoot, set(views))  # tells now, before any work, whether there are enough
        names = {other.name for other in found}
        numbered = chain([one.name], (f"{one.name}-{number}" for number in count(2)))
        found.append(replace(one, name=next(name for name in numbered if name not in names)))
    return found


def _opened(path: Path) -> OwnDetections:
    if is_shoot(path):
        shoot = open_shoot(path)
        table = next((path / name for name in TABLES if (path / name).is_file()), None)
        dots = None if table is None else _read(table, shoot)
        return OwnDetections(_name(path.resolve().name), shoot, dots)
    if not path.is_file():
        there = "is not a shoot" if path.exists() else "does not exist"
        raise InputError(f"`detections`: {path} {there}. Give a shoot's folder, or a table of its dots.")
    shoot = _home(path)
    return OwnDetections(_name(f"{shoot.folder.resolve().name}-{path.stem}"), shoot, _read(path, shoot))


def _home(path: Path) -> Shoot:
    """Return the shoot whose dots a table holds: that of its folder, or of its pictures."""
    folders = [path.parent]
    if path.suffix.lower() != CORNERS:
        table = read_detections(path)
        folders += [Path(str(table.image[0])).parent.parent] if len(table) else []
    shoot = next((folder for folder in folders if is_shoot(folder)), None)
    if shoot is None:
        raise InputError(
            f"`detections`: nothing says where the target of {path} was. Put the table into the folder of "
            "its shoot, whose shoot.json has the target and its pose in every view."
        )
    return open_shoot(shoot)


def _read(path: Path, shoot: Shoot) -> Detections:
    if path.suffix.lower() != CORNERS:
        return read_detections(path)
    endings = {f"_{camera}": camera for camera in shoot.cameras}
    return read_corners(path, shoot.target, endings, _sizes(shoot)).detections


def _sizes(shoot: Shoot) -> Callable[[Path], tuple[int, int]]:
    """Return the size of the picture that a camera of the shoot took, by the picture's name."""

    def size_of(image: Path) -> tuple[int, int]:
        for camera, entry in shoot.manifest.cameras.items():
            if image.stem.endswith(f"_{camera}"):
                return entry.size
        raise InputError(f"The picture '{image}' is of none of the cameras of {shoot.folder}.")

    return size_of


def _name(text: str) -> str:
    """Return a text as a name of letters, digits and hyphens."""
    plain = "".join(letter if letter.isascii() and letter.isalnum() else "-" for letter in text)
    return plain.strip("-")[:_MOST_NAME] or "detections"
