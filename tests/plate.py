"""A made-up plate of two boards before a pair of cameras, and the dots that a perfect detector measures."""

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.correspond.detections import Detections
from labcal.geometry.poses import from_rotation_vector
from labcal.targets.board_set import BoardSet

SIGMA_PX = 0.05
T_A_B = from_rotation_vector(np.array([0.05, -0.3, 0.1]), np.array([175.0, 12.0, 20.0]))
Sees = Callable[[int, str, str], bool]
"""Whether a board is seen in a view by a camera."""


def board(name: str, first_id: int) -> dict[str, object]:
    return {
        "kind": "charuco",
        "name": name,
        "squares": (7, 5),
        "square_mm": 20.0,
        "marker_mm": 15.0,
        "dictionary": "DICT_4X4_100",
        "first_id": first_id,
    }


PLATE = BoardSet(name="plate", targets=(board("a", 0), board("b", 40)))


def cameras() -> dict[str, Camera]:
    K = np.array([[700.0, 0.0, 322.4], [0.0, 704.0, 237.1], [0.0, 0.0, 1.0]])
    T = from_rotation_vector(np.array([0.02, 0.2, -0.03]), np.array([-160.0, 6.0, 25.0]))
    return {
        "left": Camera(K, "brown-k1k2", np.array([-0.2, 0.05, 0.0, 0.0, 0.0]), np.eye(4), (640, 480)),
        "right": Camera(K, "brown-k1k2", np.array([-0.18, 0.04, 0.0, 0.0, 0.0]), T, (640, 480)),
    }


def plate_poses(rng: np.random.Generator, views: int) -> list[np.ndarray]:
    """Return ``T_world_set`` of views in which the plate is tilted every way."""
    found = []
    for number in range(views):
        azimuth = 2 * np.pi * number / views + rng.uniform(0, 0.5)
        tilt = 0.5 * np.array([np.cos(azimuth), np.sin(azimuth), 0.5 * rng.normal()])
        R = np.diag([1.0, -1.0, -1.0]) @ Rotation.from_rotvec(tilt).as_matrix()
        middle = rng.uniform([-20, -25, 480], [90, 25, 600])
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, middle - R @ np.array([140.0, 40.0, 5.0])
        found.append(T)
    return found


def seen(
    poses: list[np.ndarray],
    sees: Sees,
    rng: np.random.Generator,
    plate: BoardSet = PLATE,
    sigma_px: float = SIGMA_PX,
) -> Detections:
    """Return what a perfect detector measures, with noise; each board by its own name and indices."""
    parts = []
    for view, T_world_set in enumerate(poses):
        for name, camera in cameras().items():
            for one, T_set_board in zip(plate.targets, (np.eye(4), T_A_B), strict=True):
                if not sees(view, name, one.name):
                    continue
                images = dot_images(
                    camera, T_world_set @ T_set_board, one.points(), 0.5 * one.outer_diameters_mm()
                )
                q = images.centroid
                q = q + sigma_px * rng.standard_normal(q.shape)
                mine = np.flatnonzero(camera.in_picture(q))
                n = len(mine)
                parts.append(
                    Detections(
                        view=np.full(n, f"v{view:02d}"),
                        camera=np.full(n, name),
                        image=np.full(n, f"v{view:02d}_{name}.png"),
                        size=np.tile(camera.size, (n, 1)),
                        index=one.indices()[mine],
                        has_id=np.full(n, fill_value=True),
                        position=q[mine],
                        covariance=np.tile(sigma_px**2 * np.eye(2), (n, 1, 1)),
                        flag=np.full(n, "ok"),
                        board=np.full(n, one.name),
                    )
                )
    names = list(parts[0].__dataclass_fields__)
    return Detections(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def in_turn(view: int, camera: str, board_name: str) -> bool:
    """Camera 1 sees board A alone and camera 2 board B alone, but in every third view both see both."""
    return view % 3 == 0 or (camera == "left") == (board_name == "a")


def never_shared(_view: int, camera: str, board_name: str) -> bool:
    """Each camera sees a board of its own, always."""
    return (camera == "left") == (board_name == "a")
