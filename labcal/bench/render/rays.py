"""Comparison of the rays of the renderer with those of the camera, and of projections with OpenCV."""

import cv2
import numpy as np

from labcal.bench.render.optics import OPTICS, description
from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENSES
from labcal.cameras.opencv_model import FISHEYE, to_order
from labcal.geometry.poses import rotation_vector
from labcal.render.camera_rays import CameraRays, Pixels, Shading
from labcal.render.samples import Samples
from labcal.render.variant import MONO, renderer
from labcal.report.bench import Check, at_most
from labcal.rng import generator

SIZES = {"1.2 megapixels": (1280, 960), "20 megapixels": (5472, 3648)}
RAYS = 100_000
DISTANCE_MM = 1500.0
LIMIT_PX = 1e-3
OPENCV_LIMIT_PX = 1e-9
PLACE = {"eye_mm": (720.0, 640.0, 1850.0), "look_at_mm": (1000.0, 1010.0, 200.0)}


def ray_checks(seed: int) -> list[Check]:
    """Return the largest distance between rays of the renderer and their pixels, by lens, window and size."""
    checks = []
    for size_name, size in SIZES.items():
        for name in OPTICS:
            camera = description(name, size, PLACE).camera()
            worst = _worst_distance(camera, generator(seed, "bench rays", name, size_name))
            checks.append(at_most(f"rays of {name}, {size_name}, px", worst, LIMIT_PX))
    return checks


def _worst_distance(camera: Camera, random: np.random.Generator) -> float:
    """Return the largest distance in px between pixels and their rays projected back."""
    width, height = camera.size
    q = random.uniform([-0.5, -0.5], [width - 0.5, height - 0.5], (RAYS, 2))
    with renderer(MONO) as mi:
        lane = mi.UInt32(np.arange(RAYS, dtype=np.uint32))
        samples = Samples(mi, lane, mi.UInt32(0), mi.UInt32(0), 1)
        pixels = Pixels(mi.Float64(q[:, 0]), mi.Float64(q[:, 1]), samples)
        ray, weight = CameraRays(mi, camera, None, Shading()).rays(pixels)
        origin, direction = (np.array(part, np.float64).T for part in (ray.o, ray.d))
        traced = np.array(weight) > 0.0
    back = camera.project(origin + DISTANCE_MM * direction)
    if not (traced & back.ok).all():
        return float("nan")
    return float(np.linalg.norm(back.q - q, axis=1).max())


def opencv_checks(seed: int) -> list[Check]:
    """Return the differences of projections from OpenCV, for the models that it has."""
    checks = []
    for name, lens in LENSES.items():
        if lens.opencv is None:
            continue
        camera = description(name, SIZES["1.2 megapixels"], PLACE).camera()
        random = generator(seed, "bench OpenCV", name)
        q = random.uniform([0, 0], [camera.size[0] - 1, camera.size[1] - 1], (RAYS // 10, 2))
        rays = camera.rays(q)
        front = rays.direction @ camera.T_cam_world[2, :3] > 0.1  # noqa: PLR2004 -- OpenCV divides by z
        p = (rays.origin + random.uniform(300.0, 3000.0, (len(q), 1)) * rays.direction)[front]
        rvec, tvec = rotation_vector(camera.T_cam_world), camera.T_cam_world[:3, 3]
        dist = np.zeros(len(lens.opencv.order))
        held = to_order(lens.opencv, lens.names, tuple(camera.dist.tolist()))
        dist[: len(held)] = held
        if lens.opencv is FISHEYE:
            expected, _ = cv2.fisheye.projectPoints(p[:, None], rvec, tvec, camera.K, dist)
        else:
            expected, _ = cv2.projectPoints(p, rvec, tvec, camera.K, dist)
        difference = np.abs(camera.project(p).q - np.asarray(expected).reshape(-1, 2)).max()
        checks.append(
            at_most(f"projection of {name} against OpenCV's, px", float(difference), OPENCV_LIMIT_PX)
        )
    return checks
