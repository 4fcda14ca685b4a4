"""The noise of finitely many rays at the edges of rendered photographs."""

import numpy as np
import pytest

from labcal.bench.held_board import board_scene, still_take, tilted_pose
from labcal.guide.twin.ray_noise import ray_variance, with_lamps
from labcal.render.film import Cells
from labcal.render.irradiance import Case
from labcal.render.paper_share import EdgeRays, PaperShare, SharpShare, paper_share
from labcal.scene.board import Board
from labcal.scene.camera import CameraDescription
from labcal.targets.catalogue import load_target


def test_lamps_add_noise_to_shares_between_paper_and_ink_alone() -> None:
    values = np.tile(np.float32([0.0, 0.25, 0.5, 1.0]), 20_000)
    cells = np.broadcast_to(values[:, None, None], (len(values), 2, 2)).copy()
    share = SharpShare.of(np.zeros((20_000, 4), np.float32), np.arange(len(values)), Cells(cells, None))
    made = PaperShare(share, (share,))
    rough = with_lamps(made, 0.01, np.random.default_rng(0)).rough[0]
    variance = ((rough.pixels - share.pixels) ** 2).mean(axis=0)
    assert variance[0] == 0.0
    assert variance[3] == 0.0
    wanted = 0.01 * np.array([0.25 * 0.75, 0.5 * 0.5])
    assert np.abs(variance[1:3] / wanted - 1.0).max() < 4.0 * np.sqrt(2.0 / 20_000)
    assert with_lamps(made, 0.0, np.random.default_rng(0)) is made


@pytest.mark.parametrize("rays", [16, 24, 64])
def test_the_variance_by_rays_is_that_of_pictures_traced_again(rays: int) -> None:
    target = load_target("paper-13x10")
    camera = CameraDescription(
        size=(160, 120), focal_px=200.0, lens="pinhole", eye_mm=(0.0, 0.0, 600.0), look_at_mm=(0.0, 0.0, 0.0)
    )
    scene = board_scene(target, camera, 1)
    board = Board(dark=(0.0, 0.0, 0.0), light=(1.0, 1.0, 1.0), plate=(1.0, 1.0, 1.0))
    scene = scene.model_copy(update={"board": board})
    take = still_take(scene, tilted_pose(target, 20.0, 0.3, 0.1, np.zeros(3)))
    draws = 12
    made = paper_share(scene, Case(take, 0), EdgeRays(1024, rays, 1 + draws))
    exact = made.share.behind(0.8)
    stated = ray_variance(made, 0.8)[8:-8, 8:-8]
    off2 = np.stack([(one.behind(0.8) - exact)[8:-8, 8:-8] ** 2 for one in made.rough[1:]])
    noisy = stated > 0.2 * stated.max()
    for pixels in (noisy, stated < np.median(stated[noisy]), stated >= np.median(stated[noisy])):
        ratio = off2[:, pixels].sum(axis=1) / stated[pixels].sum()
        assert abs(ratio.mean() - 1.0) < 4.0 * ratio.std(ddof=1) / np.sqrt(draws) + 0.15
