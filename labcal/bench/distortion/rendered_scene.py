"""The scene that shows a board of dots to a family's cameras, on planes across its volume."""

import numpy as np

from labcal.bench.distortion.case import Cell, Pictures
from labcal.bench.distortion.seeing_pixels import cut, seeing_margin
from labcal.bench.families.registry import EYES_MM, LOOK_AT_MM, Family, family_by_name
from labcal.bench.families.volume import COLS, ROWS, TABLE, Volume
from labcal.cameras.camera import Camera
from labcal.scene.camera import CameraDescription
from labcal.scene.lamps import Ambient, Panel
from labcal.scene.model import Scene
from labcal.scene.photometry import Photometry
from labcal.scene.placement import EvenHeights, Planes
from labcal.scene.room import Room
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid

TARGET = "paper-13x10"
SENSOR = {"preset": "machine-vision-5mp", "fall_off": False, "exposure_stops": -5.0, "bits": 16}
"""A good sensor in dim light: dots have a noise of some 0.02 px, beside which that of 32 rays a pixel, some
0.006 px, hardly counts. In full light the rays would make most of the error, which no detector knows of."""
NAMES = ("left", "right")
_LAMP_MM, _LAMP_SIZE_MM, _LAMP_RADIANCE, _AMBIENT_RADIANCE = (0.0, -500.0, 6000.0), 1500.0, 9.0, 0.4
_BEHIND_MM = 1500.0
"""From the volume to the back wall."""


def rendered_scene(cell: Cell, pictures: Pictures, seed: int) -> Scene:
    """Return the scene of a cell.

    The board of the paper, stretched to the volume's width and depth, lies on planes at equal intervals
    across the volume, its faces included. The test views are half-way between them, half a pitch to the side.
    Light falls off nowhere, so that all families are pictured alike. Pictures lack the margin of
    :func:`~labcal.bench.distortion.seeing_pixels.seeing_margin`.

    Raises
    ------
    UnknownNameError
        There is no such family.
    InputError
        The cameras see no direction.
    """
    family = family_by_name(cell.family)
    volume = family.volume(cell.strength)
    low, high = volume.low, volume.high
    middle = (0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2])
    return Scene(
        name="bench-distortion",
        target=board(volume),
        cameras=_cameras(family, cell.strength, seed),
        placement=Planes(
            kind="planes",
            origin_mm=low[:2],
            heights_mm=EvenHeights(first=low[2], last=high[2], count=pictures.views),
        ),
        lamps=(
            Panel(
                centre_mm=_LAMP_MM,
                look_at_mm=middle,
                size_mm=(_LAMP_SIZE_MM, _LAMP_SIZE_MM),
                radiance=_LAMP_RADIANCE,
            ),
            Ambient(kind="ambient", radiance=_AMBIENT_RADIANCE),
        ),
        room=Room(wall_y_mm=high[1] + _BEHIND_MM),
        photometry=Photometry.model_validate(SENSOR),
        spp=pictures.spp,
    )


def board(volume: Volume) -> DotGrid:
    """Return the paper's board, stretched to the width and depth of a volume.

    Dots grow with the square root of the stretch: those nearest to a camera with a wide field then do not
    become too large for an ellipse, nor those at its rim too small to be measured.
    """
    target = load_target(TARGET)
    if not isinstance(target, DotGrid):
        raise TypeError(TARGET)
    across, along = (volume.high[i] - volume.low[i] for i in (0, 1))
    usual = TABLE.high[0] - TABLE.low[0]
    growth = float(np.sqrt(min(across, along) / usual))
    diameters = {
        name: growth * getattr(target, name)
        for name in ("dot_diameter_mm", "ring_outer_diameter_mm", "ring_inner_diameter_mm", "margin_mm")
    }
    pitches = {"pitch_x_mm": across / (COLS - 1), "pitch_y_mm": along / (ROWS - 1)}
    return DotGrid.model_validate({**target.model_dump(), **pitches, **diameters})


def _cameras(family: Family, strength: float, seed: int) -> dict[str, CameraDescription]:
    pair = family.pair(strength, seed)
    margin = seeing_margin(pair)
    return {
        name: _description(cut(camera, margin), eye)
        for name, camera, eye in zip(NAMES, pair, EYES_MM, strict=True)
    }


def _description(camera: Camera, eye_mm: tuple[float, float, float]) -> CameraDescription:
    """Return the description of a family's camera, which has one focal length and looks where all do."""
    focal_px, _, cx, cy = camera.intrinsics
    return CameraDescription(
        size=camera.size,
        focal_px=focal_px,
        principal_px=(cx, cy),
        lens=camera.lens,
        dist=tuple(camera.dist.tolist()),
        prescription=camera.prescription,
        window=camera.window,
        eye_mm=eye_mm,
        look_at_mm=LOOK_AT_MM,
    )
