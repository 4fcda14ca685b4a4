"""A shoot on disk: pictures, and the manifest that describes them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from labcal.arguments import choice_of
from labcal.arrays import Pose
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.public_object import PublicObject
from labcal.run.documents import read_document
from labcal.run.made import is_as_made, renew
from labcal.run.outputs import write_file
from labcal.shoot.manifest import Manifest, Role, ViewEntry
from labcal.targets.catalogue import AnyTarget, target_of
from labcal.targets.print_scale import AnyPrintScale, printed_to_scale

if TYPE_CHECKING:
    import matplotlib.figure

MANIFEST = "shoot.json"


@dataclass(frozen=True, eq=False, repr=False)
class Shoot(PublicObject):
    """A shoot's folder and its manifest. Two are equal where both are; pictures are not compared.

    Examples
    --------
    >>> from labcal import examples
    >>> shoot = examples.shoot("shoot")
    >>> shoot
    Shoot(folder=shoot, target=plain-11x8, cameras=['left', 'right'], train=1, test=1)
    >>> [view.name for view in shoot.views()]
    ['hand-0', 'hand-1']
    """

    folder: Path
    """Folder of ``shoot.json`` and the pictures."""
    manifest: Manifest
    """Content of ``shoot.json``."""

    @classmethod
    def load(cls, folder: AnyPath) -> "Shoot":
        """Open a shoot; as :func:`open_shoot`, which lists its errors."""
        return open_shoot(folder)

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw the pictures, small, of up to twelve views spread evenly over the shoot.

        Raises
        ------
        InputError
            A picture cannot be read.
        """
        from labcal.shoot.shoot_figure import shoot_figure  # noqa: PLC0415 -- imports matplotlib

        return shoot_figure(self)

    def _summary(self) -> Mapping[str, object]:
        summary: dict[str, object] = {"folder": self.folder.as_posix(), "target": self._target_name}
        summary["cameras"] = list(self.cameras)
        return {**summary, "train": len(self.views(Role.TRAIN)), "test": len(self.views(Role.TEST))}

    @property
    def target(self) -> AnyTarget:
        """The target that was shot.

        Raises
        ------
        InputError
            The shoot was captured without naming one.
        """
        if self.manifest.target is None:
            raise InputError(
                f"The shoot {self.folder} does not tell which target it shows. Name it: `target='NAME'` "
                "('labcal target list' shows the names)."
            )
        return self.manifest.target

    @property
    def _target_name(self) -> str | None:
        return None if self.manifest.target is None else self.manifest.target.name

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras, in the manifest's order."""
        return tuple(self.manifest.cameras)

    def views(self, role: Role | str | None = None) -> tuple[ViewEntry, ...]:
        """Return the views with a role, ``"train"`` or ``"test"``, or all.

        Raises
        ------
        UnknownNameError, InputTypeError
            There is no such role.

        Examples
        --------
        >>> from labcal import examples
        >>> [view.name for view in examples.shoot("shoot").views("test")]
        ['hand-1']
        """
        wanted = None if role is None else choice_of(role, Role, "role")
        return tuple(view for view in self.manifest.views if wanted is None or view.role is wanted)

    def showing(self, target: AnyTarget | AnyPath) -> "Shoot":
        """Return the shoot with another target, by itself or by name, than the one in its manifest.

        Raises
        ------
        UnknownNameError, InputError, InputTypeError
            There is no such target.
        """
        other = target_of(target)
        number = self.manifest.print_number if _one_design(other, self.manifest.target) else None
        manifest = self.manifest.model_copy(update={"target": other, "print_number": number})
        return replace(self, manifest=manifest)

    def with_print_scale(self, print_scale: AnyPrintScale) -> "Shoot":
        """Return the shoot with its target as the print has it whose ruler was measured; nothing is written.

        Parameters
        ----------
        print_scale : str, float or tuple of float
            Measured over nominal length, such as ``"99.8/100"``; for x and y apart, ``"99.8/100,100.1/100"``.

        Raises
        ------
        InputError, InputTypeError
            The scale is stated already, or is none.
        """
        return self.showing(printed_to_scale(self.target, print_scale))

    def nominal_poses(self) -> dict[str, Pose]:
        """Return ``T_world_target_nominal`` (mm) of the views that have one."""
        return {
            view.name: np.array(view.T_world_target_nominal)
            for view in self.manifest.views
            if view.T_world_target_nominal is not None
        }


def is_shoot(folder: AnyPath) -> bool:
    """Return whether a folder holds a manifest."""
    return (as_path(folder) / MANIFEST).is_file()


def open_shoot(folder: AnyPath) -> Shoot:
    """Open a shoot.

    Parameters
    ----------
    folder : str or os.PathLike
        The folder with ``shoot.json``.

    Returns
    -------
    Shoot

    Raises
    ------
    InputError
        There is no manifest, it is not one that this version reads, or the shoot has no pictures.

    Examples
    --------
    >>> from labcal import examples, open_shoot
    >>> made = examples.shoot("shoot")
    >>> open_shoot("shoot") == made
    True
    """
    folder = as_path(folder)
    if not is_shoot(folder):
        raise InputError(
            f"{folder} is not a shoot: it has no {MANIFEST}. Give the folder that 'labcal render' made."
        )
    manifest = read_document(Manifest, "manifest", folder / MANIFEST)
    if not manifest.views:
        raise InputError(f"The shoot {folder} has no pictures. Render or capture it again.")
    return Shoot(folder, manifest)


def _one_design(target: AnyTarget, other: AnyTarget | None) -> bool:
    """Return whether two targets differ in the scale of the print at most."""
    if other is None:
        return False
    first, second = ({**one.model_dump(), "print_scale": None} for one in (target, other))
    return first == second


def write_manifest(folder: AnyPath, manifest: Manifest) -> None:
    """Write ``shoot.json`` into a folder, with labcal's mark of a finished one kept true.

    Raises
    ------
    OutputError
        The disk refuses.
    """
    path = as_path(folder) / MANIFEST
    was_ours = is_as_made(path)
    write_file(path, manifest.model_dump_json(indent=2) + "\n", force=True)
    if was_ours:
        renew(path)
