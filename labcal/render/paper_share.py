"""The share of each pixel that shows the lighter of a print's two colours: geometry alone, sharp.

Edges are traced with many rays, since what the light, the blur and the noise make of them is added afterwards
and compared with a photograph; where a pixel and all its neighbours show one colour, a few rays tell it.
"""

import cv2
import numpy as np
from jaxtyping import Float32

from labcal.render.irradiance import Case
from labcal.render.laboratories import Laboratories
from labcal.render.laboratory import Draw
from labcal.render.variant import MONO, renderer
from labcal.rng import integer_seed
from labcal.scene.model import Scene

FEW = 4
"""Rays of every pixel; they find the edges."""
_SAME = 1e-6
_BESIDE = 3
"""Side of the neighbourhood of a pixel in which an edge may be."""


def paper_share(scene: Scene, case: Case, spp: int) -> Float32[np.ndarray, "h w"]:
    """Render the share of the paper in each pixel of a picture, 0 to 1.

    Parameters
    ----------
    scene : Scene
        With ambient light of radiance 1, paper of reflectance 1 and ink of 0: light is then the share.
    case : Case
        A picture of a target that stands still.
    spp : int
        Rays of a pixel at an edge.

    Raises
    ------
    DeviceError
        The renderer does not work on this machine.
    """
    camera = case.take.device
    width, height = camera.size
    seed = integer_seed(case.seed, case.view, case.camera)
    with renderer(MONO) as mi:
        laboratory = Laboratories(mi, scene, case.seed).of_size(camera.size)
        rays = laboratory.rays_of(camera)
        laboratory.place(case.take.track.at(0.0))
        share = np.zeros((height, width), dtype=np.float32)
        step = laboratory.rows_at_once(FEW)
        for top in range(0, height, step):
            rows = slice(top, min(top + step, height))
            share[rows] = laboratory.trace(rays, rows, Draw(seed, FEW, 0, FEW))
        around = np.ones((_BESIDE, _BESIDE), dtype=np.uint8)
        uneven = cv2.dilate(share, around) - cv2.erode(share, around) > _SAME
        edges = np.flatnonzero(uneven)
        share.reshape(-1)[edges] = laboratory.trace_pixels(rays, edges, Draw(seed, spp, 0, spp))
    return share
