"""Sources of pictures: a shoot, or loose files whose names give view and camera."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.arguments import one_text, wrong_type
from labcal.correspond.camera_advice import mend_of_endings, mend_of_twins
from labcal.correspond.name_patterns import ANY, CAMERA, VIEW, best_pattern, camera_in, view_in
from labcal.correspond.named_cameras import named_cameras
from labcal.correspond.picture_folders import endings_seen, picture_files
from labcal.errors import InputError
from labcal.run.names import differ_in_case, is_name
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.shoot.pictures import SUFFIXES, read_picture
from labcal.shoot.raw_pictures import RawFormat, read_raw_picture
from labcal.wording import clipped, has_control, listed, printable


@dataclass(frozen=True)
class Source:
    """One picture to measure."""

    view: str
    camera: str
    image: str
    """The path as given."""
    size: tuple[int, int] | None
    """Size that the shoot states; None for a loose picture."""
    raw: RawFormat | None = None
    """The pixel format, where the file does not tell it."""

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
        picture = read_picture(self.image) if self.raw is None else read_raw_picture(self.image, self.raw)
        size = (picture.shape[1], picture.shape[0])
        if self.size is not None and size != self.size:
            raise InputError(
                f"The picture {self.image} is {size[0]} x {size[1]}, but the shoot states that camera "
                f"'{self.camera}' takes {self.size[0]} x {self.size[1]}. Put the original back."
            )
        return picture


def parse_camera_endings(text: str) -> dict[str, str]:
    """Return camera by ending or pattern of the file name, from text like ``_0=left,_1=right``.

    In a pattern ``*`` stands for what the view is called: ``left*=left,right*=right`` or, of folders,
    ``LEFT/*=left,RIGHT/*=right``. ``*=camera`` says that all pictures are of one camera. One pattern with
    named parts tells all cameras: ``shot_{view}_cam{camera}_x`` or ``{camera}/{view}``.

    Raises
    ------
    InputError
        The text is not of that form.
    """
    if CAMERA in text:
        return {_named_parts(text): CAMERA}
    endings = {}
    for part in text.split(","):
        ending, equals, camera = part.partition("=")
        if not (ending and equals and is_name(camera)) or ending in endings:
            raise InputError(
                "`cameras` takes endings of file names or patterns, each once, and names of letters, digits "
                f"and hyphens, as in '_0=left,_1=right' or 'left*=left,right*=right', but got '{text}'."
            )
        endings[ending] = camera
    return endings


def _named_parts(pattern: str) -> str:
    """Return a pattern with the view and the camera as named parts, checked."""
    suffix = Path(pattern).suffix
    pattern = pattern.removesuffix(suffix) if suffix.lower() in SUFFIXES else pattern
    if VIEW not in pattern and ANY not in pattern and pattern.endswith(CAMERA) and pattern != CAMERA:
        pattern = VIEW + pattern  # the end of the names, as '-cam{camera}'
    others = pattern.replace(VIEW, "\0").replace(ANY, "\0")
    if pattern.count(CAMERA) != 1 or "\0" not in others:
        raise InputError(
            "A pattern with named parts has {camera} once, and {view} for the rest that differs, as in "
            f"'shot_{{view}}_cam{{camera}}', but got '{pattern}'."
        )
    if f"{CAMERA}\0" in others or f"\0{CAMERA}" in others:
        raise InputError(
            f"In '{pattern}' nothing stands between {{camera}} and {{view}}, so that it is open where one "
            "ends. Write what is between them, or name each camera: 'left*=left,right*=right'."
        )
    return pattern


def camera_endings(cameras: Mapping[str, str] | str) -> dict[str, str]:
    """Return camera by ending or pattern of the file name, from a mapping, or from text.

    Raises
    ------
    InputError
        The text is as of :func:`parse_camera_endings`, or the mapping holds what is no name of a camera.
    InputTypeError
        It is neither.
    """
    if isinstance(cameras, str):
        return parse_camera_endings(cameras)
    if not isinstance(cameras, Mapping):
        raise wrong_type(cameras, "a mapping of endings to names, or a text", "cameras")
    if list(cameras.values()) == [CAMERA]:
        return {_named_parts(one_text(ending, "cameras")): CAMERA for ending in cameras}
    for ending, camera in cameras.items():
        if not (one_text(ending, "cameras") and is_name(one_text(camera, "cameras"))):
            raise InputError(
                "`cameras` maps endings of file names or patterns to names of letters, digits and hyphens, "
                f"but {clipped(repr(ending))} to {clipped(repr(camera))} was given."
            )
    return dict(cameras)


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
        Files, folders and lists of pictures as given; of a folder without pictures, those in its folders.
    endings : mapping of str to str
        Camera by ending or pattern of the name (see :func:`parse_camera_endings`); the view is the rest of
        the name. Where empty, all are of one camera named ``camera`` and the view is the whole name.

    Raises
    ------
    InputError
        A path does not exist, a name fits no ending, two pictures are the same view of the same camera, views
        or cameras differ only in capital letters, there is no picture at all, or names tell of several
        cameras and `endings` is empty.
    """
    sources: dict[tuple[str, str], Source] = {}
    images = picture_files(paths)
    refuse_unnamed_cameras(images, endings)
    for image in images:
        source = loose_source(image, endings, images)
        twin = sources.setdefault((source.view, source.camera), source)
        if twin is not source:
            raise InputError(
                f"{twin.image} and {source.image} are both view '{source.view}' of camera '{source.camera}'. "
                + mend_of_twins(twin.image, source.image, images, endings)
            )
    if not sources:
        raise InputError(
            f"There are no pictures ({', '.join(sorted(SUFFIXES))}) in {listed(paths)}{endings_seen(paths)}."
        )
    for kind in ("view", "camera"):
        alike = differ_in_case(dict.fromkeys(str(getattr(source, kind)) for source in sources.values()))
        if alike is not None:
            raise InputError(
                f"The {kind}s '{alike[0]}' and '{alike[1]}' differ only in capital letters, so that their "
                "files would be the same ones on many disks. Rename the pictures of one of them."
            )
    return [sources[key] for key in sorted(sources)]


def refuse_unnamed_cameras(images: Sequence[str], endings: Mapping[str, str]) -> None:
    """Raise if names of pictures suggest several cameras and `--cameras` was not given.

    Raises
    ------
    InputError
        They do; it says what to give for `endings`.
    """
    cameras = None if endings else named_cameras(images)
    if cameras is not None:
        raise InputError(cameras.words())


def loose_source(image: str, endings: Mapping[str, str], images: Sequence[str] = ()) -> Source:
    """Return the source that the name of a loose picture gives.

    Parameters
    ----------
    image : str
        Path of the picture.
    endings : mapping of str to str
        As of :func:`loose_sources`.
    images : sequence of str, optional
        All pictures, for which advice has to work.

    Raises
    ------
    InputError
        The name fits no ending.
    """
    if not endings:
        return Source(Path(image).stem, "camera", image, None)
    pattern = best_pattern(image, endings)
    if pattern is None:
        fits = (
            "fits" if any(mark in known for known in endings for mark in (ANY, VIEW, CAMERA)) else "ends in"
        )
        raise InputError(
            f"The name of {image} {fits} none of {', '.join(endings)}, so its camera is not known. "
            + mend_of_endings(image, images or [image], endings)
        )
    camera = camera_in(image, pattern, endings[pattern])
    if not is_name(camera):
        raise InputError(
            f"By '{pattern}' the camera of {image} is called '{clipped(printable(camera))}', but names of "
            "cameras are of letters, digits and hyphens. Put what is constant into the pattern, or name each "
            "camera: 'left*=left,right*=right'."
        )
    return Source(view_in(image, pattern) or "", camera, image, None)


def find_sources(paths: Sequence[str], endings: Mapping[str, str]) -> list[Source]:
    """Return the pictures of one shoot, or loose ones.

    Raises
    ------
    InputError
        See :func:`loose_sources` and :func:`labcal.shoot.dataset.open_shoot`.

    Examples
    --------
    >>> from pathlib import Path
    >>> from labcal.pipeline import find_sources
    >>> for name in ("a_0.png", "a_1.png", "b_0.png", "b_1.png"):
    ...     Path(name).touch()
    >>> for source in find_sources(["."], {"_0": "left", "_1": "right"}):
    ...     print(source.view, source.camera, source.image)
    a left a_0.png
    a right a_1.png
    b left b_0.png
    b right b_1.png
    """
    if len(paths) == 1 and is_shoot(Path(paths[0])):
        return shoot_sources(open_shoot(Path(paths[0])))
    return loose_sources(paths, endings)
