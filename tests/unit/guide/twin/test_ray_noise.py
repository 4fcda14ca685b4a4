"""The noise of finitely many rays at the edges of rendered photographs."""

import numpy as np

from labcal.guide.twin.ray_noise import with_lamps
from labcal.render.paper_share import PaperShare


def test_lamps_add_noise_to_shares_between_paper_and_ink_alone() -> None:
    share = np.repeat(np.float32([[0.0, 0.25, 0.5, 1.0]]), 20_000, axis=0)
    made = PaperShare(share, share > 0.0, (share,))
    rough = with_lamps(made, 0.01, np.random.default_rng(0)).rough[0]
    variance = ((rough - share) ** 2).mean(axis=0)
    assert variance[0] == 0.0
    assert variance[3] == 0.0
    wanted = 0.01 * np.array([0.25 * 0.75, 0.5 * 0.5])
    assert np.abs(variance[1:3] / wanted - 1.0).max() < 4.0 * np.sqrt(2.0 / 20_000)
    assert with_lamps(made, 0.0, np.random.default_rng(0)) is made
