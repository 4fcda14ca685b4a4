"""The lenses and windows of the benchmark, for any picture size."""

from typing import Any

from labcal.scene.camera import CameraDescription

_BROWN = (-0.3, 0.09, 0.0006, -0.0004, 0.0)
_RATIONAL = (0.9, -0.4, 0.0006, -0.0004, 0.05, 1.25, -0.2, 0.03)
_PRISM = (0.002, -0.001, -0.0015, 0.0008)
_WATER = {
    "kind": "flat",
    "distance_mm": 200.0,
    "tilt_x_deg": 30.0,
    "thickness_mm": 10.0,
    "behind_index": 1.333,
}
_WAVES = [
    {"amplitude_px": [3.0, 0.0], "period_px": 300.0, "direction_deg": 20.0},
    {"amplitude_px": [0.0, 3.0], "period_px": 310.0, "direction_deg": 80.0, "phase_deg": 70.0},
    {"amplitude_px": [1.5, -1.5], "period_px": 420.0, "direction_deg": -50.0, "phase_deg": 200.0},
]
PARAMETRIC: dict[str, dict[str, Any]] = {
    "pinhole": {"lens": "pinhole"},
    "brown-k1k2": {"lens": "brown-k1k2", "dist": _BROWN[:2]},
    "brown5": {"lens": "brown5", "dist": _BROWN},
    "rational8": {"lens": "rational8", "dist": _RATIONAL},
    "thin-prism12": {"lens": "thin-prism12", "dist": (*_RATIONAL, *_PRISM)},
    "tilted14": {"lens": "tilted14", "dist": (*_RATIONAL, *_PRISM, 0.06, -0.09)},
    "fisheye-kb4": {"lens": "fisheye-kb4", "dist": (-0.04, 0.01, -0.006, 0.001)},
    "double-sphere": {"lens": "double-sphere", "dist": (-0.2, 0.6)},
    "eucm": {"lens": "eucm", "dist": (0.6, 1.1)},
    "omni-radtan": {"lens": "omni-radtan", "dist": (1.2, -0.1, 0.02, 6e-4, -4e-4)},
    "telecentric": {"lens": "telecentric", "dist": _BROWN},
}
REFRACTED: dict[str, dict[str, Any]] = {
    "webcam prescription": {"lens": "prescription", "prescription": "webcam-doublet"},
    "double gauss": {"lens": "prescription", "prescription": "double-gauss"},
    "tilted pane": {"lens": "pinhole", "window": {"kind": "flat", "distance_mm": 80.0, "tilt_y_deg": 25.0}},
    "water behind a tilted window": {"lens": "brown5", "dist": _BROWN, "window": _WATER},
    "wavy pane": {"lens": "brown5", "dist": _BROWN, "window": {"kind": "wavy", "waves": _WAVES}},
}
OPTICS = PARAMETRIC | REFRACTED
_FOCAL_OVER_WIDTH = {
    "fisheye-kb4": 0.45, "double-sphere": 0.37, "eucm": 0.45, "omni-radtan": 0.95, "double gauss": 1.9,
}  # fmt: skip
"""The fisheye and those like it see some 150 degrees along the diagonal; the photographic lens has a half
field of 22 degrees."""


def description(name: str, size: tuple[int, int], place: dict[str, Any]) -> CameraDescription:
    """Return a camera with the named optics.

    Parameters
    ----------
    name : str
        Of :data:`OPTICS`.
    size : (int, int)
        Width and height, px.
    place : dict
        ``eye_mm``, ``look_at_mm`` and perhaps ``up`` of the description.
    """
    focal_px = _FOCAL_OVER_WIDTH.get(name, 1.1) * size[0]
    return CameraDescription.model_validate({"size": size, "focal_px": focal_px, **OPTICS[name], **place})
