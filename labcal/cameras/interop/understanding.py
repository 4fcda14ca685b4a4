"""Report of what was understood of files of cameras, before anything is made of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from labcal.cameras.camera import Camera
from labcal.cameras.interop.conversion import ConvertSettings, read_options
from labcal.cameras.interop.remarks import remarks_on
from labcal.cameras.interop.rig_files import baseline_mm, chosen_cameras, read_rig_files
from labcal.paths import AnyPath, as_path
from labcal.public_object import HtmlTable, PublicObject

_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Of a picture, from the top left clockwise: 0 is the first pixel, 1 the last one."""


@dataclass(frozen=True)
class UnderstoodCamera:
    """One camera as it was read."""

    lens: str
    """Lens model."""
    dist: dict[str, float]
    """Coefficients by their names."""
    size: tuple[int, int]
    """Width and height of the pictures, px."""
    focal_px: tuple[float, float]
    """Along x and y; px/mm for a lens of parallel rays."""
    principal_point_px: tuple[float, float]
    """The centre of the first pixel is (0, 0)."""
    centre_mm: tuple[float, float, float]
    """In the world of the rig."""
    field_of_view_deg: tuple[float | None, float | None, float | None]
    """Between the outermost pixels of the middle row, the middle column and the diagonal; null where there
    are no rays."""
    corners_undistorted_px: list[tuple[float, float] | None]
    """The corners of the picture, from the top left clockwise, as a pinhole of the same K images them; null
    where it does not."""


@dataclass(frozen=True, eq=False, repr=False)
class Understood(PublicObject):
    """Cameras as they were read; the JSON document of ``labcal convert --check``."""

    source: str
    """Format of the files."""
    unit: str | None
    """Unit that lengths in the files were taken for."""
    baseline_mm: float | None
    """From the first camera to the second; null for one."""
    cameras: dict[str, UnderstoodCamera]
    notes: list[str]

    def _summary(self) -> Mapping[str, object]:
        return {"source": self.source, "unit": self.unit, "baseline_mm": self.baseline_mm}

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [[name, *(value for _, value in described(one))] for name, one in self.cameras.items()]
        head = [label for label, _ in described(next(iter(self.cameras.values())))]
        return [HtmlTable(["camera", *head], rows)]


def understood_cameras(inputs: Sequence[AnyPath], settings: ConvertSettings) -> Understood:
    """Read files of cameras and return what was understood.

    Parameters
    ----------
    inputs : sequence of paths
        A file, one a camera, or a folder.
    settings : ConvertSettings
        Those that go with reading.

    Raises
    ------
    InputError
        The files cannot be read, or a setting would be dropped.
    """
    settings.refuse(("to_format",), "is of what is written, and nothing is written")
    given = read_options(settings)
    source, found = read_rig_files([as_path(one) for one in inputs], settings.from_format, given)
    rig = chosen_cameras(found.rig, list(settings.only)) if settings.only else found.rig
    cameras = {name: rig.camera(name) for name in rig.cameras}
    return Understood(
        source=source.name,
        unit=None if found.unit is None else found.unit.value,
        baseline_mm=baseline_mm(rig),
        cameras={name: _understood(camera) for name, camera in cameras.items()},
        notes=[*found.notes, *remarks_on(cameras, source)],
    )


def described(camera: UnderstoodCamera) -> list[tuple[str, str]]:
    """Return what was understood of a camera as texts, each with a label."""
    degrees = ["none" if one is None else f"{one:.4g}" for one in camera.field_of_view_deg]
    corners = [
        "none" if one is None else f"({one[0]:.1f}, {one[1]:.1f})" for one in camera.corners_undistorted_px
    ]
    return [
        ("picture", f"{camera.size[0]} x {camera.size[1]} px"),
        ("lens", camera.lens),
        ("coefficients", ", ".join(f"{name} {value:.6g}" for name, value in camera.dist.items()) or "none"),
        ("focal length", f"{camera.focal_px[0]:.6g}, {camera.focal_px[1]:.6g} px"),
        ("principal point", f"({camera.principal_point_px[0]:.6g}, {camera.principal_point_px[1]:.6g}) px"),
        ("field of view", f"{degrees[0]} x {degrees[1]} degrees, diagonal {degrees[2]}"),
        ("corners undistorted", f"{' '.join(corners)} px"),
        ("centre", f"({', '.join(f'{one:.6g}' for one in camera.centre_mm)}) mm"),
    ]


def _understood(camera: Camera) -> UnderstoodCamera:
    """Return what there is to know of one camera."""
    fx, fy, cx, cy = camera.intrinsics
    last = np.array(camera.size) - 1.0
    names = camera.model.names
    x, y, z = (float(one) for one in camera.centre)
    return UnderstoodCamera(
        lens=camera.lens,
        dist=dict(zip(names, (float(one) for one in camera.dist), strict=False)),
        size=(int(camera.size[0]), int(camera.size[1])),
        focal_px=(fx, fy),
        principal_point_px=(cx, cy),
        centre_mm=(x, y, z),
        field_of_view_deg=(
            _angle_deg(camera, last * [0.0, 0.5], last * [1.0, 0.5]),
            _angle_deg(camera, last * [0.5, 0.0], last * [0.5, 1.0]),
            _angle_deg(camera, last * 0.0, last),
        ),
        corners_undistorted_px=[_undistorted(camera, last * corner) for corner in _CORNERS],
    )


def _angle_deg(camera: Camera, first: np.ndarray, second: np.ndarray) -> float | None:
    """Return the angle between the rays of two pixels, over the principal point; None without rays."""
    _, _, cx, cy = camera.intrinsics
    rays = camera.rays(np.array([first, [cx, cy], second]))
    if not rays.ok.all():
        return None
    a, axis, b = rays.direction
    halves = [np.arctan2(np.linalg.norm(np.cross(axis, one)), axis @ one) for one in (a, b)]
    return float(np.degrees(sum(halves)))


def _undistorted(camera: Camera, q: np.ndarray) -> tuple[float, float] | None:
    """Return where a pinhole with the same K sees what a pixel sees; None if it is not in front of it."""
    if camera.model.parallel:
        return None
    rays = camera.rays(q[None])
    x, y, z = camera.T_cam_world[:3, :3] @ rays.direction[0]
    if not (rays.ok[0] and z > 0.0):
        return None
    fx, fy, cx, cy = camera.intrinsics
    return float(fx * x / z + cx), float(fy * y / z + cy)
