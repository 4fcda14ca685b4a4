"""Pictures as a user gives them, resolved once: those of a shoot, or loose ones."""

import os.path
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel

from labcal.arguments import wrong_type
from labcal.cameras.rig import Rig
from labcal.correspond.pictures_left_out import left_out_words
from labcal.correspond.sources import Source, camera_endings, find_sources, shoot_sources
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.public_object import PublicObject
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.targets.catalogue import AnyTarget, target_of
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
    """

    sources: tuple[Source, ...]
    shoot: Shoot | None
    name: str
    given: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    def _summary(self) -> Mapping[str, object]:
        cameras = list(dict.fromkeys(source.camera for source in self.sources))
        return {"name": self.name, "pictures": len(self.sources), "cameras": cameras}

    @property
    def roles(self) -> dict[str, str]:
        """``train`` or ``test`` of each view of a shoot; empty for loose pictures."""
        return {} if self.shoot is None else {view.name: view.role.value for view in self.shoot.views()}

    def target(self, given: "AnyTarget | AnyPath | None" = None, rig: Rig | None = None) -> AnyTarget:
        """Return the target that is given, by itself or by name, or else that of the shoot or of a rig.

        Raises
        ------
        UnknownNameError
            There is no target of that name.
        InputError
            None is given, and neither a shoot nor a rig states one.
        """
        return target_shown(given, self.shoot, rig)


AnyPictures = PictureSet | Shoot | AnyPath | Sequence[AnyPath]
"""Pictures as public functions take them: a shoot, or paths of pictures and folders."""


def open_pictures(pictures: AnyPictures, cameras: Mapping[str, str] | str | None = None) -> PictureSet:
    """Return the pictures of a shoot, or loose ones, with the cameras that took them.

    Parameters
    ----------
    pictures : PictureSet, Shoot, path, or sequence of paths
        A shoot or its folder; or pictures and folders of pictures.
    cameras : mapping of str to str, or str, optional
        Cameras of loose pictures by the end of the name, or by a pattern: ``"_0=left,_1=right"``; see
        :func:`~labcal.correspond.sources.parse_camera_endings`.

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
        if cameras is not None:
            raise InputError(
                "`cameras` is for loose pictures; a shoot names the camera of each. Leave it out."
            )
        return PictureSet(tuple(shoot_sources(shoot)), shoot, _name(shoot.folder), (str(shoot.folder),))
    paths = _texts(pictures)
    if not paths:
        raise InputError("No picture is given. Give a shoot, or pictures and folders of pictures.")
    endings = {} if cameras is None else camera_endings(cameras)
    left_out = tuple(left_out_words(paths))
    return PictureSet(tuple(find_sources(paths, endings)), None, _name(paths[0]), tuple(paths), left_out)


def target_shown(
    given: "AnyTarget | AnyPath | None", shoot: Shoot | None, rig: Rig | None = None
) -> AnyTarget:
    """Return the target that is given, by itself or by name, or else that of the shoot or of a rig.

    Parameters
    ----------
    given : AnyTarget, str, path or None
    shoot : Shoot or None
        The shoot that the pictures are of; where it states a target, that of the rig is not looked at.
    rig : Rig, optional
        The cameras that dots are of, which may keep the target of their calibration.

    Raises
    ------
    UnknownNameError
        There is no target of that name.
    InputError
        None is given, and neither a shoot nor a rig states one; or that of the rig is damaged.
    """
    if given is not None:
        return target_of(given)
    kept = None
    if rig is not None and (shoot is None or shoot.manifest.target is None):
        kept = kept_target(rig)
    if kept is not None:
        return kept
    if shoot is None:
        raise InputError(
            "Name the target that the pictures show: `target='NAME'` ('labcal target list' shows the names)."
        )
    return shoot.target


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
