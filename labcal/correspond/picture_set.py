"""Pictures as a user gives them, resolved once: those of a shoot, or loose ones."""

import os.path
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path

from pydantic import BaseModel

from labcal.arguments import one_text, wrong_type
from labcal.cameras.rig import Rig
from labcal.correspond.camera_lists import camera_lists, list_sources
from labcal.correspond.name_patterns import CAMERA
from labcal.correspond.one_camera import doubts
from labcal.correspond.picture_folders import picture_files
from labcal.correspond.pictures_left_out import left_out_words
from labcal.correspond.printed_target import ShownTarget, named_target, read_target
from labcal.correspond.sources import Source, camera_endings, find_sources, shoot_sources
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.public_object import PublicObject
from labcal.run.progress import Progress
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.shoot.raw_pictures import RAW_SUFFIXES, parse_raw_format
from labcal.targets.catalogue import AnyTarget, AnyTargets
from labcal.targets.code_text import PrintedTarget
from labcal.targets.kept_target import kept_target


@dataclass(frozen=True, eq=False, repr=False)
class PictureSet(PublicObject):
    """Pictures to measure.

    Attributes
    ----------
    sources : tuple of Source
        Each picture with its view and its camera.
    shoot : Shoot or None
        The shoot that they are of; None for loose pictures.
    name : str
        Of the folder or file that was given first.
    given : tuple of str
        Paths as they were given.
    warnings : tuple of str
        Files in the folders that are left out, for people.
    endings : str
        What tells the cameras of loose pictures, as ``--cameras`` takes it; empty where nothing was given.
    raw : str
        Their pixel format, as ``--raw`` takes it; empty where nothing was given.
    """

    sources: tuple[Source, ...]
    shoot: Shoot | None
    name: str
    given: tuple[str, ...]
    warnings: tuple[str, ...] = ()
    endings: str = ""
    raw: str = ""

    def _summary(self) -> Mapping[str, object]:
        cameras = list(dict.fromkeys(source.camera for source in self.sources))
        return {"name": self.name, "pictures": len(self.sources), "cameras": cameras}

    @property
    def roles(self) -> dict[str, str]:
        """``train`` or ``test`` of each view of a shoot; empty for loose pictures."""
        return {} if self.shoot is None else {view.name: view.role.value for view in self.shoot.views()}

    def target(self, given: "AnyTargets | None" = None, rig: Rig | None = None) -> AnyTarget:
        """Return the target that is given, by itself or by name, of the shoot, of a print or of a rig.

        Raises
        ------
        UnknownNameError
            There is no target of that name.
        InputError
            None is given, no shoot states it, no code of a print tells it, or several do, and no rig keeps
            it.
        """
        return target_shown(given, self.shoot, self.sources, rig).target

    def shown(
        self,
        given: "AnyTargets | PrintedTarget | None" = None,
        executor: Executor | None = None,
        progress: Progress | None = None,
    ) -> ShownTarget:
        """Return the target as :meth:`target` does, with the print and the picture that tell it.

        Raises
        ------
        UnknownNameError, InputError
            As of :meth:`target`.
        """
        return target_shown(given, self.shoot, self.sources, None, executor, progress)


AnyPictures = PictureSet | Shoot | AnyPath | Sequence[AnyPath]
"""Pictures as public functions take them: a shoot, or paths of pictures and folders."""


def open_pictures(
    pictures: AnyPictures, cameras: Mapping[str, str] | str | None = None, raw: str | None = None
) -> PictureSet:
    """Return the pictures of a shoot, or loose ones, with the cameras that took them.

    Parameters
    ----------
    pictures : PictureSet, Shoot, path, or sequence of paths
        A shoot or its folder; or pictures and folders of pictures.
    cameras : mapping of str to str, or str, optional
        Cameras of loose pictures by the end of the name, or by a pattern: ``"_0=left,_1=right"``; see
        :func:`~labcal.correspond.sources.parse_camera_endings`. Or by lists, text files with a path a line,
        or folders: ``"left=left.txt,right=right.txt"``; pictures in the same line are one view.
    raw : str, optional
        Pixel format of loose pictures that hold a mosaic, or have no header: ``"BayerRG8"``,
        ``"Mono12p:1280x1024"``; see :func:`~labcal.shoot.raw_pictures.parse_raw_format`. Of a folder without
        pictures, the files that end in .raw or .bin are then read.

    Returns
    -------
    PictureSet
        Each picture with its view and camera.

    Raises
    ------
    InputError
        There are no such pictures, their names do not tell which camera took them, or `cameras` is given
        for a shoot.
    InputTypeError
        `pictures` or `cameras` is of a wrong type.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot", views=1)
    >>> pipeline.open_pictures(shoot).roles
    {'hand-0': 'test'}
    >>> loose = pipeline.open_pictures("shoot/images", cameras="_left=a,_right=b")
    >>> [(source.view, source.camera) for source in loose.sources]
    [('hand-0', 'a'), ('hand-0', 'b')]
    """
    if isinstance(pictures, PictureSet):
        return pictures
    shoot = _shoot(pictures)
    if shoot is not None:
        if raw is not None:
            raise InputError(
                "`raw` is for loose pictures; a shoot has pictures that state their form. Leave it out."
            )
        if cameras is not None:
            raise InputError(
                "`cameras` is for loose pictures; a shoot names the camera of each. Leave it out."
            )
        return PictureSet(tuple(shoot_sources(shoot)), shoot, _name(shoot.folder), (str(shoot.folder),))
    paths = _texts(pictures)
    if not paths:
        raise InputError("No picture is given. Give a shoot, or pictures and folders of pictures.")
    form = None if raw is None else parse_raw_format(one_text(raw, "raw"))
    paths = paths if form is None else with_raw_files(paths)
    left_out, stated = tuple(left_out_words(paths)), "" if raw is None else raw
    lists = camera_lists(cameras)
    if lists is not None:
        listed_ones, unlisted = list_sources(picture_files(paths), lists, form)
        text = ",".join(f"{camera}={place}" for camera, place in lists.items())
        warnings = (*left_out, *unlisted)
        return PictureSet(tuple(listed_ones), None, _name(paths[0]), tuple(paths), warnings, text, stated)
    endings = {} if cameras is None else camera_endings(cameras)
    text = ",".join(
        ending if camera == CAMERA else f"{ending}={camera}" for ending, camera in endings.items()
    )
    sources = tuple(replace(source, raw=form) for source in find_sources(paths, endings))
    doubt = None if endings else doubts([source.image for source in sources])
    warnings = left_out if doubt is None else (*left_out, doubt)
    return PictureSet(sources, None, _name(paths[0]), tuple(paths), warnings, text, stated)


def with_raw_files(paths: Sequence[str]) -> list[str]:
    """Return paths with the files without a header in place of folders that have such ones."""
    found: list[str] = []
    for path in paths:
        folder = Path(path)
        entries = sorted(folder.iterdir()) if folder.is_dir() else []
        files = [str(entry) for entry in entries if entry.suffix.lower() in RAW_SUFFIXES]
        found += files or [path]
    return found


def target_shown(
    given: "AnyTargets | PrintedTarget | None",
    shoot: Shoot | None,
    sources: Sequence[Source] = (),
    rig: Rig | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> ShownTarget:
    """Return the target that is given, by itself or by name, of the shoot, of a print or of a rig.

    Parameters
    ----------
    given : AnyTarget, PrintedTarget, path or str, optional
    shoot : Shoot, optional
    sources : sequence of Source
        Pictures in which the code of a print is searched where neither tells the target.
    rig : Rig, optional
        The cameras that dots are of. The target of their calibration is taken where no code is read, and
        tells which of several prints is meant.
    executor : Executor, optional
        It searches; in this process where left out.
    progress : Progress, optional

    Raises
    ------
    UnknownNameError
        There is no target of that name.
    InputError
        None is given, no shoot states it, no code of a print tells it, or several do, and no rig keeps it;
        or the target that the rig keeps is damaged.
    """
    if given is not None:
        return named_target(given)
    if shoot is not None and shoot.manifest.target is not None:
        number = shoot.manifest.print_number
        target = shoot.manifest.target
        return ShownTarget(target if number is None else PrintedTarget(target, number))
    kept = None if rig is None else kept_target(rig)
    if not sources and kept is not None:
        return ShownTarget(kept)
    if not sources:
        raise InputError(
            "Name the target that the pictures show: `target='NAME'` ('labcal target list' shows the names)."
        )
    return read_target(sources, kept, executor, progress)


def _shoot(pictures: AnyPictures) -> Shoot | None:
    """Return the shoot that is given, alone; None for loose pictures."""
    if isinstance(pictures, Shoot):
        return pictures
    paths = _texts(pictures)
    return open_shoot(Path(paths[0])) if len(paths) == 1 and is_shoot(Path(paths[0])) else None


def _texts(pictures: AnyPictures) -> list[str]:
    """Return paths as text."""
    if isinstance(pictures, str | os.PathLike):
        return [_text(pictures)]
    if isinstance(pictures, Iterable) and not isinstance(pictures, bytes | Mapping | BaseModel):
        return [_text(path) for path in pictures]
    raise wrong_type(pictures, "a shoot, a path, or a sequence of paths", "pictures")


def _text(path: AnyPath) -> str:
    as_path(path)  # raises where it is none
    return os.fspath(path)


def _name(path: AnyPath) -> str:
    return Path(os.path.realpath(path)).name  # of a loop of links, too
