"""Small made-up data to try things on: a rig, the dots that it sees, and where they are.

Nothing is rendered or detected, so that all of it is there at once; every call gives the same numbers. The
examples of the documentation start from these.
"""

from collections.abc import Iterator
from functools import cache

import numpy as np

from labcal.arguments import whole_number
from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import DotImages, dot_images
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.points import Points
from labcal.errors import InputError, OutputError
from labcal.evaluate.acceptance.reference_lengths import ReferenceLengths
from labcal.geometry.poses import from_rotation_vector, pose
from labcal.guide.rehearsal.rehearsal import Rehearsal, rehearsed
from labcal.guide.rehearsal.rig_plan import RigPlan
from labcal.paths import AnyPath, as_path
from labcal.reconstruct.reconstruction import reconstruct_points
from labcal.rng import generator
from labcal.shoot.dataset import MANIFEST, Shoot, open_shoot, write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid

SIGMA_PX = 0.02
"""Standard deviation of the dots' positions along each axis."""
TARGET = "plain-11x8"
_VIEWS = 8
_SIZE = (640, 480)
_TILT_RAD = 0.45
_DISTANCE_MM = 550.0
_PAPER, _INK = 220, 30
"""Grey values of a drawn picture."""
_BLOCK = {
    "origin": (-40.0, 30.0, 600.0),
    "right-corner": (60.0, 30.0, 600.0),
    "upper-corner": (-40.0, -40.0, 610.0),
    "far-corner": (-40.0, 30.0, 690.0),
    "tip": (10.0, -10.0, 560.0),
}
"""Places of named points in the world of :func:`rig`, mm."""


def rig() -> Rig:
    """Return a rig of two cameras, 200 mm apart and turned towards each other; the left one is the world.

    Examples
    --------
    >>> list(rig().cameras)
    ['left', 'right']
    """
    left = Camera(
        [[800.0, 0.0, 322.0], [0.0, 800.0, 238.0], [0.0, 0.0, 1.0]], "brown5",
        [-0.12, 0.05, 3e-4, -2e-4, 0.0], np.eye(4), _SIZE,
    )  # fmt: skip
    towards = from_rotation_vector(np.array([0.0, 0.3, 0.0]), np.zeros(3))[:3, :3]
    right = Camera(
        [[805.0, 0.0, 318.0], [0.0, 805.0, 241.0], [0.0, 0.0, 1.0]], "brown5",
        [-0.11, 0.04, -2e-4, 3e-4, 0.0], pose(towards, -towards @ [200.0, 0.0, 0.0]), _SIZE,
    )  # fmt: skip
    return Rig.of({"left": left, "right": right})


def detections() -> Detections:
    """Return the dots of the target :data:`TARGET`, held in eight places before :func:`rig`.

    Positions are centroids with normal noise of :data:`SIGMA_PX`; dots that are not wholly in the picture are
    flagged ``cut``.

    Examples
    --------
    >>> detections().views[:3]
    ('hand-0', 'hand-1', 'hand-2')
    """
    target, rng = _target(), generator(0, "examples")
    n = target.count
    parts: list[tuple[str, str, np.ndarray, np.ndarray]] = []
    for view, name, seen in _seen(_VIEWS):
        whole = seen.ok & rig().camera(name).in_picture(seen.outline).all(axis=-1)
        parts.append((view, name, whole, seen.centroid + rng.normal(0.0, SIGMA_PX, (n, 2))))
    whole = np.concatenate([part[2] for part in parts])
    position = np.concatenate([part[3] for part in parts])
    return Detections(
        view=np.repeat([part[0] for part in parts], n),
        camera=np.repeat([part[1] for part in parts], n),
        image=np.repeat([f"{part[0]}_{part[1]}.png" for part in parts], n),
        size=np.tile(_SIZE, (len(position), 1)),
        index=np.tile(target.indices(), (len(parts), 1)),
        has_id=np.ones(len(position), dtype=bool),
        position=np.where(whole[:, None], position, np.nan),
        covariance=np.where(whole[:, None, None], SIGMA_PX**2 * np.eye(2), np.nan),
        flag=np.where(whole, "ok", "cut"),
    )


def points() -> Points:
    """Return the points that :func:`rig` reconstructs from :func:`detections`.

    Examples
    --------
    >>> points().point.shape[1]
    3
    """
    return reconstruct_points(rig(), detections(), load_target(TARGET))


def pixels() -> NamedPixels:
    """Return the pixels of five named points, a block's corners and a tip, in both cameras of :func:`rig`.

    Examples
    --------
    >>> pixels()
    NamedPixels(views=1, cameras=['left', 'right'], points=5, pixels=10, with_covariance=10)
    """
    return _pixels_of("block", np.zeros(3))


def moved_pixels() -> NamedPixels:
    """Return the pixels of the block before and after a motion of 2 mm to the right, as views of their own.

    Examples
    --------
    >>> moved_pixels()
    NamedPixels(views=2, cameras=['left', 'right'], points=5, pixels=20, with_covariance=20)
    """
    before, after = pixels(), _pixels_of("moved", np.array([2.0, 0.0, 0.0]))
    columns = ("view", "camera", "point", "position", "covariance")
    return NamedPixels(*(np.concatenate([getattr(before, name), getattr(after, name)]) for name in columns))


def _pixels_of(view: str, motion: Vectors3) -> NamedPixels:
    """Return the pixels of the block in a view, after a motion (mm)."""
    cameras = rig()
    names, places = list(_BLOCK), np.array(list(_BLOCK.values())) + motion
    position = np.concatenate([cameras.camera(name).project(places).q for name in cameras.cameras])
    noise = generator(0, "examples", "pixels", *([] if view == "block" else [view]))
    position += SIGMA_PX * noise.normal(size=position.shape)
    return NamedPixels(
        view=np.full(len(position), view),
        camera=np.repeat(list(cameras.cameras), len(names)),
        point=np.tile(names, len(cameras.cameras)),
        position=position,
        covariance=np.tile(SIGMA_PX**2 * np.eye(2), (len(position), 1, 1)),
    )


def lengths() -> ReferenceLengths:
    """Return three known edges of the block of :func:`pixels`, as an acceptance test has them.

    Examples
    --------
    >>> lengths().point_b.tolist()
    ['right-corner', 'far-corner', 'upper-corner']
    """
    ends, block = ("right-corner", "far-corner", "upper-corner"), np.full(3, "block")
    origin = np.array(_BLOCK["origin"])
    nominal = [float(np.linalg.norm(np.array(_BLOCK[end]) - origin)) for end in ends]
    return ReferenceLengths(
        ["1"] * 3, ["1", "2", "3"], block, ["origin"] * 3, block, ends, nominal, [0.002] * 3
    )


def shoot(folder: AnyPath, views: int = 2) -> Shoot:
    """Return a shoot of the first views of :func:`detections`, whose pictures are drawn into a folder.

    The pictures are 8-bit PNGs without noise: white, with dark dots. The last view has the role ``test``. A
    folder that holds this shoot already is opened as it is.

    Parameters
    ----------
    folder : path
        The folder to appear, with ``shoot.json`` and the pictures.
    views : int
        Number of views, 1 to 8.

    Raises
    ------
    InputError, InputTypeError
        There are no so many views.
    OutputError
        The folder or a file in it cannot be written, or the folder holds other pictures.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     print([view.name for view in shoot(folder).views()])
    ['hand-0', 'hand-1']
    """
    from labcal.shoot.pictures import write_picture  # noqa: PLC0415 -- imports OpenCV, which points do not need

    views = whole_number(views, "views", 1)
    if views > _VIEWS:
        raise InputError(f"`views` is at most {_VIEWS}, but {views} was given.")
    place, pictures = as_path(folder), dict[str, dict[str, str]]()
    drawn = {f"images/{view}_{name}.png": (view, name, seen) for view, name, seen in _seen(views)}
    for path, (view, name, _) in drawn.items():
        pictures.setdefault(view, {})[name] = path
    roles = [*[Role.TRAIN] * (views - 1), Role.TEST]
    entries = [
        ViewEntry(name=view, images=images, role=role, T_world_target_nominal=None)
        for (view, images), role in zip(pictures.items(), roles, strict=True)
    ]
    cameras = {name: CameraEntry(size=_SIZE) for name in rig().cameras}
    manifest = Manifest(target=load_target(TARGET), cameras=cameras, views=tuple(entries))
    there = [path for path in (MANIFEST, *drawn) if (place / path).exists()]
    if len(there) > len(drawn) and open_shoot(place).manifest == manifest:
        return Shoot(place, manifest)
    if there:
        raise OutputError(f"{place} holds {there[0]}, but not this example. Choose another folder.")
    (place / "images").mkdir(parents=True, exist_ok=True)
    for path, (_, _, seen) in drawn.items():
        write_picture(place / path, _drawn(seen))
    write_manifest(place, manifest)
    return Shoot(place, manifest)


def rig_plan() -> RigPlan:
    """Return the plan of a pair of small cameras half a metre in front of a target.

    Examples
    --------
    >>> from labcal import examples
    >>> examples.rig_plan().geometry.baseline_mm
    150.0
    """
    camera = {"size": _SIZE, "fov_deg": 50.0, "lens": "brown-k1k2", "dist": (-0.1, 0.02)}
    target = {
        "name": "small-9x7", "cols": 9, "rows": 7, "pitch_x_mm": 18.0, "pitch_y_mm": 18.0,
        "dot_diameter_mm": 8.0, "ring_outer_diameter_mm": 8.0, "ring_inner_diameter_mm": 3.5,
        "rings": {"origin": (2, 2), "x": (6, 2), "y": (2, 5)}, "margin_mm": 10.0,
    }  # fmt: skip
    return RigPlan.model_validate(
        {
            "name": "small",
            "camera": camera,
            "geometry": {"kind": "pair", "baseline_mm": 150.0, "convergence_mm": 500.0},
            "volume": {"width_mm": 140.0, "height_mm": 100.0, "near_mm": 450.0, "far_mm": 550.0},
            "photometry": {"format": "png"},
            "target": target,
            "print_sigma_mm": 0.01,
            "shoot": {"views": 6},
        }
    )


@cache
def rehearsal() -> Rehearsal:
    """Return the rehearsal of :func:`rig_plan`, made once.

    Examples
    --------
    >>> from labcal import examples
    >>> len(examples.rehearsal().views)
    6
    """
    return rehearsed(rig_plan(), 0)


def _target() -> DotGrid:
    """Return the target :data:`TARGET`."""
    target = load_target(TARGET)
    assert isinstance(target, DotGrid)  # noqa: S101 -- for the checker of types
    return target


def _seen(views: int) -> Iterator[tuple[str, str, DotImages]]:
    """Return view, camera and the images of all dots, for each picture of the first views."""
    target, cameras = _target(), rig()
    centres, radii = target.points(), 0.5 * target.outer_diameters_mm()
    for number in range(views):
        T_world_target = _held(number, centres.mean(axis=0))
        for name in cameras.cameras:
            yield f"hand-{number}", name, dot_images(cameras.camera(name), T_world_target, centres, radii)


def _drawn(seen: DotImages) -> np.ndarray:
    """Return a picture of dots, uint8, shape (height, width): each pixel is the mean of 8 x 8 samples."""
    import cv2  # noqa: PLC0415 -- takes 0.3 s to import, and only pictures need it

    fine, bits = 8, 4
    width, height = _SIZE
    picture = np.full((fine * height, fine * width), _PAPER, dtype=np.uint8)
    # The centre of pixel 0 is at 0 in the picture, and at (fine - 1) / 2 in the fine one.
    corners = np.rint((fine * (seen.outline[seen.ok] + 0.5) - 0.5) * 2**bits).astype(np.int32)
    for outline in corners:
        cv2.fillConvexPoly(picture, outline, _INK, cv2.LINE_8, bits)
    return np.asarray(cv2.resize(picture, _SIZE, interpolation=cv2.INTER_AREA))


def _held(number: int, middle: np.ndarray) -> Pose:
    """Return the pose of a target in the hand, tilted another way each time."""
    around = 2.0 * np.pi * number / _VIEWS
    tilt = from_rotation_vector(_TILT_RAD * np.array([np.cos(around), np.sin(around), 0.0]), np.zeros(3))
    R = np.diag([1.0, -1.0, -1.0]) @ tilt[:3, :3]
    place = [25.0 + 60.0 * np.cos(2.0 * around), 50.0 * np.sin(2.0 * around), _DISTANCE_MM + 25.0 * number]
    return pose(R, place - R @ middle)
