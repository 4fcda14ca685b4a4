"""Where pictures come from: a shoot, or loose files whose names tell view and camera."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.errors import InputError
from labcal.run.names import is_name
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.shoot.pictures import SUFFIXES, read_picture
from labcal.wording import clipped, has_control, printable


@dataclass(frozen=True)
class Source:
    """One picture to measure."""

    view: str
    camera: str
    image: str
    """The path as given."""
    size: tuple[int, int] | None
    """What the shoot says the size is; None for a loose picture."""

    def __post_init__(self) -> None:
        """Refuse a name that no table can hold, and that a terminal would obey."""
        if has_control(self.image):
            raise InputError(
                f"The name of the picture '{clipped(printable(self.image))}' holds control characters, or "
                "bytes that are no UTF-8. Rename it."
            )

    def read(self) -> np.ndarray:
        """Return the picture; see :func:`read_picture` for its form.

        Raises
        ------
        InputError
            It cannot be read, or is not of the size that the shoot states.
        """
        picture = read_picture(Path(self.image))
        size = (picture.shape[1], picture.shape[0])
        if self.size is not None and size != self.size:
            raise InputError(
                f"The picture {self.image} is {size[0]} x {size[1]}, but the shoot says that camera "
                f"'{self.camera}' takes {self.size[0]} x {self.size[1]}. Put the original back."
            )
        return picture


def parse_camera_endings(text: str) -> dict[str, str]:
    """Return camera by ending of the file name, from text like ``_0=left,_1=right``.

    Raises
    ------
    InputError
        The text is not of that form.
    """
    endings = {}
    for part in text.split(","):
        ending, equals, camera = part.partition("=")
        if not (ending and equals and is_name(camera)) or ending in endings:
            raise InputError(
                "--cameras takes endings of file names, each once, and names of letters, digits and hyphens, "
                f"as in '_0=left,_1=right', but got '{text}'."
            )
        endings[ending] = camera
    return endings


def shoot_sources(shoot: Shoot) -> list[Source]:
    """Return every picture of a shoot, view by view."""
    return [
        Source(view.name, camera, str(shoot.folder / relative), shoot.manifest.cameras[camera].size)
        for view in shoot.views()
        for camera, relative in view.images.items()
    ]


def loose_sources(paths: Sequence[str], endings: Mapping[str, str]) -> list[Source]:
    """Return loose pictures, sorted by view and camera; folders stand for the pictures in them.

    Parameters
    ----------
    paths : sequence of str
        Files and folders as given.
    endings : mapping of str to str
        Camera by ending of the name without its suffix; the view is the rest of the name. Where empty, all
        are of one camera named ``camera`` and the view is the whole name.

    Raises
    ------
    InputError
        A path does not exist, a name fits no ending, two pictures are the same view of the same camera, or
        there is no picture at all.
    """
    sources: dict[tuple[str, str], Source] = {}
    for image in _files(paths):
        source = loose_source(image, endings)
        twin = sources.setdefault((source.view, source.camera), source)
        if twin is not source:
            raise InputError(
                f"{twin.image} and {source.image} are both view '{source.view}' of camera '{source.camera}'. "
                "Give them different names, or tell the cameras apart with --cameras '_0=left,_1=right'."
            )
    if not sources:
        raise InputError(f"There are no pictures ({', '.join(sorted(SUFFIXES))}) in {', '.join(paths)}.")
    return [sources[key] for key in sorted(sources)]


def loose_source(image: str, endings: Mapping[str, str]) -> Source:
    """Return what the name of a loose picture says about it.

    Raises
    ------
    InputError
        The name fits no ending.
    """
    stem = Path(image).stem
    if not endings:
        return Source(stem, "camera", image, None)
    fitting = [ending for ending in endings if stem.endswith(ending) and stem != ending]
    if not fitting:
        raise InputError(
            f"The name of {image} ends in none of {', '.join(endings)}, so its camera is not known."
        )
    ending = max(fitting, key=len)
    return Source(stem.removesuffix(ending), endings[ending], image, None)


def _files(paths: Sequence[str]) -> list[str]:
    found: list[str] = []
    for given in paths:
        path = Path(given)
        if path.is_dir():
            found += sorted(str(entry) for entry in path.iterdir() if entry.suffix.lower() in SUFFIXES)
        elif path.is_file():
            found.append(given)
        else:
            raise InputError(f"There is no picture or folder {given}.")
    return found


def find_sources(paths: Sequence[str], endings: Mapping[str, str]) -> list[Source]:
    """Return the pictures of one shoot, or loose ones.

    Raises
    ------
    InputError
        See :func:`loose_sources` and :func:`labcal.shoot.dataset.open_shoot`.
    """
    if len(paths) == 1 and is_shoot(Path(paths[0])):
        return shoot_sources(open_shoot(Path(paths[0])))
    return loose_sources(paths, endings)
