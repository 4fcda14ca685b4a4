"""The share of each pixel that shows the lighter of a print's two colours: geometry alone, sharp.

Edges are traced with many rays, since what the light, the blur and the noise make of them is added afterwards
and compared with a photograph; where a pixel and all its neighbours show one colour, a few rays tell it.
"""

from dataclasses import dataclass
from types import ModuleType

import cv2
import numpy as np
from jaxtyping import Bool, Float32

from labcal.render.camera_rays import CameraRays
from labcal.render.irradiance import Case
from labcal.render.laboratories import Laboratories
from labcal.render.laboratory import Draw, Laboratory
from labcal.render.variant import MONO, renderer
from labcal.rng import integer_seed
from labcal.scene.model import Scene

FEW = 4
"""Rays of every pixel; they find the edges."""
_SAME = 1e-6
_BESIDE = 3
"""Side of the neighbourhood of a pixel in which an edge may be."""


@dataclass(frozen=True)
class PaperShare:
    """The share of paper in each pixel of a picture.

    Attributes
    ----------
    share : float32 array, (h, w)
        0 to 1.
    edges : bool array, (h, w)
        Pixels that were traced with many rays.
    rough : tuple of float32 array, (h, w)
        The same share with fewer rays, as often as it was asked for.
    """

    share: Float32[np.ndarray, "h w"]
    edges: Bool[np.ndarray, "h w"]
    rough: tuple[Float32[np.ndarray, "h w"], ...] = ()


@dataclass(frozen=True)
class EdgeRays:
    """Rays of pixels at edges.

    Attributes
    ----------
    spp : int
        Of the share itself.
    rough_spp, rough : int
        Rays of further, rougher shares, and how many of these are wanted.
    """

    spp: int
    rough_spp: int = 1
    rough: int = 0


def paper_share(scene: Scene, case: Case, wanted: EdgeRays) -> PaperShare:
    """Render the share of the paper in each pixel of a picture.

    Parameters
    ----------
    scene : Scene
        With ambient light of radiance 1, paper of reflectance 1 and ink of 0: light is then the share.
    case : Case
        A picture of a target that stands still.
    wanted : EdgeRays

    Raises
    ------
    DeviceError
        The renderer does not work on this machine.
    """
    with renderer(MONO) as mi:
        laboratory, rays = _placed(mi, scene, case)
        width, height = case.take.device.size
        seed = integer_seed(case.seed, case.view, case.camera)
        share = np.zeros((height, width), dtype=np.float32)
        step = laboratory.rows_at_once(FEW)
        for top in range(0, height, step):
            rows = slice(top, min(top + step, height))
            share[rows] = laboratory.trace(rays, rows, Draw(seed, FEW, 0, FEW))
        around = np.ones((_BESIDE, _BESIDE), dtype=np.uint8)
        edges = cv2.dilate(share, around) - cv2.erode(share, around) > _SAME
        at = np.flatnonzero(edges)
        share.reshape(-1)[at] = laboratory.trace_pixels(rays, at, Draw(seed, wanted.spp, 0, wanted.spp))
        rough = []
        for number in range(wanted.rough):
            other = integer_seed(case.seed, case.view, case.camera, f"rough {number}")
            again, count = share.copy(), wanted.rough_spp
            again.reshape(-1)[at] = laboratory.trace_pixels(rays, at, Draw(other, count, 0, count))
            rough.append(again)
    return PaperShare(share, edges, tuple(rough))


def _placed(mi: ModuleType, scene: Scene, case: Case) -> tuple[Laboratory, CameraRays]:
    """Return the laboratory with the target in place, and the rays of the camera."""
    camera = case.take.device
    laboratory = Laboratories(mi, scene, case.seed).of_size(camera.size)
    laboratory.place(case.take.track.at(0.0))
    return laboratory, laboratory.rays_of(camera)
