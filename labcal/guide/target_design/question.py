"""The question that a design answers: cameras, distances, tilts, and paper."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from labcal.bounds import MOST_MM
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.run.names import Name
from labcal.scene.photometry import Photometry
from labcal.targets.paper import PAPERS, PRINTER_MARGIN_MM, SHEET_BORDER_MM, Paper
from labcal.targets.registry import PLAIN, target_kinds
from labcal.targets.tiles import MOST_TILES

USUAL_TILT_DEG = 50.0
"""Tilt up to which a target is to be found, where none is asked for."""
MOST_TILT_DEG = 70.0
"""Up to which the detector was tried."""


@dataclass(frozen=True)
class TargetQuestion:
    """Cameras, distances, tilts and paper for which a target is wanted.

    Parameters
    ----------
    cameras : mapping of str to Camera
        By name; their places do not matter.
    near_mm, far_mm : float
        Least and greatest distance of the target from the cameras.
    paper : Paper
    tiles : (int, int)
        Sheets side by side and one above the other.
    tilt_max_deg : float
        Greatest angle of the target's normal to the line of sight.
    kind : str
        Kind of the target.
    photometry : Photometry
        The sensors.
    printer_margin_mm : float
        Rim that the printer leaves bare.
    room_mm : (float, float), optional
        Largest width and height of the board, such as those of the working volume.
    name : str, optional
        Name of the target; made of paper and counts where left out.

    Raises
    ------
    InputError
        There is no camera, or a number is out of bounds.

    Examples
    --------
    >>> from labcal import examples
    >>> from labcal.pipeline import TargetQuestion
    >>> rig = examples.rig()
    >>> cameras = {name: rig.camera(name) for name in rig.cameras}
    >>> TargetQuestion(cameras, near_mm=400.0, far_mm=900.0).middle_mm
    600.0
    """

    cameras: Mapping[str, Camera]
    near_mm: float
    far_mm: float
    paper: Paper = PAPERS["a4"]
    tiles: tuple[int, int] = (1, 1)
    tilt_max_deg: float = USUAL_TILT_DEG
    kind: str = PLAIN
    photometry: Photometry = field(default_factory=lambda: Photometry.model_validate("machine-vision-5mp"))
    printer_margin_mm: float = PRINTER_MARGIN_MM
    room_mm: tuple[float, float] | None = None
    name: Name | None = None

    def __post_init__(self) -> None:
        if not self.cameras:
            raise InputError("A target is designed for cameras, and none is given. Give one or more.")
        if not 0.0 < self.near_mm <= self.far_mm <= MOST_MM:
            raise InputError(
                f"The distances should be a near and a far one between 0 and {MOST_MM:g} mm, but are "
                f"{self.near_mm:g} and {self.far_mm:g} mm."
            )
        if not 0.0 <= self.tilt_max_deg <= MOST_TILT_DEG:
            raise InputError(
                f"The greatest tilt should be 0 to {MOST_TILT_DEG:g} degrees, but is {self.tilt_max_deg:g}."
            )
        if not 0.0 <= self.printer_margin_mm <= 0.2 * self.paper.width_mm:
            raise InputError(
                f"The printer's margin should be 0 to a fifth of the paper's width, but is "
                f"{self.printer_margin_mm:g} mm."
            )
        if min(self.tiles) < 1 or self.tiles[0] * self.tiles[1] > MOST_TILES:
            raise InputError(
                f"The tiles should be 1x1 to {MOST_TILES} sheets, but are {self.tiles[0]}x{self.tiles[1]}."
            )
        if self.kind not in _DESIGNED:
            known = ", ".join(kind for kind in target_kinds() if kind in _DESIGNED)
            raise InputError(f"Targets are designed of the kinds {known}, not of '{self.kind}'.")
        if self.room_mm is not None and not min(self.room_mm) > 0.0:
            raise InputError("The room for the board should be two lengths above 0 mm.")

    @property
    def middle_mm(self) -> float:
        """Usual distance: the geometric mean of the near and the far one."""
        return float(np.sqrt(self.near_mm * self.far_mm))

    @property
    def border_mm(self) -> float:
        """Bare rim on each side beyond the one that a sheet has anyway."""
        return max(0.0, self.printer_margin_mm - SHEET_BORDER_MM)

    @property
    def different_cameras(self) -> dict[str, Camera]:
        """The cameras by name, of those alike the first."""
        found: dict[str, Camera] = {}
        for name, camera in self.cameras.items():
            if not any(_alike(camera, other) for other in found.values()):
                found[name] = camera
        return found


_DESIGNED = (PLAIN, "charuco", "coded-dots")


def _alike(one: Camera, other: Camera) -> bool:
    """Tell whether two cameras have one lens and one picture, wherever they are."""
    return (
        one.size == other.size
        and one.lens == other.lens
        and np.array_equal(one.K, other.K)
        and np.array_equal(one.dist, other.dist)
    )
