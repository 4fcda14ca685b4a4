import numpy as np
import pytest

from labcal.render.surfaces import surface_plugin
from labcal.render.variant import MONO, Jit, renderer


def evaluated(mi: Jit, pattern: Jit, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return a pattern's factors at places in mm."""
    at = [mi.Float(values.astype(np.float32)) for values in np.broadcast_arrays(x, y)]
    return np.array(pattern(*at), dtype=np.float64)


def test_every_other_tile_is_darker_and_joints_lie_between() -> None:
    with renderer(MONO) as mi:
        from labcal.render.patterns import GROUT_MM, tiles  # noqa: PLC0415 -- imports Dr.Jit

        middles = np.arange(24) * 500.0 + 250.0
        x, y = np.meshgrid(middles, middles)
        shade = evaluated(mi, tiles(500.0), x.ravel(), y.ravel()).reshape(x.shape)
        light = (np.add.outer(np.arange(24), np.arange(24)) % 2) == 0
        assert shade[light].min() > shade[~light].max()
        assert np.ptp(shade[light]) > 0.05  # no two are alike
        across = evaluated(mi, tiles(500.0), 1000.0 + np.arange(0.0, 10.0, 0.5), np.array(1250.0))
        np.testing.assert_allclose(across[np.arange(0.0, 10.0, 0.5) < GROUT_MM], 0.6)
        assert (across[np.arange(0.0, 10.0, 0.5) > GROUT_MM] > 0.7).all()


def test_planks_have_joints_and_a_wall_has_its_skirting_below() -> None:
    with renderer(MONO) as mi:
        from labcal.render.patterns import JOINT_MM, PLANK_MM, SKIRTING_MM, planks, plaster  # noqa: PLC0415

        x = np.linspace(0.0, 1500.0, 300)
        assert (evaluated(mi, planks, x, np.array(3.0 * PLANK_MM + 0.5 * JOINT_MM)) < 0.5).all()
        wood = evaluated(mi, planks, x, np.array(3.5 * PLANK_MM))
        assert 0.01 < wood.std() < 0.1
        assert (evaluated(mi, plaster, x, np.array(0.5 * SKIRTING_MM)) > 1.3).all()
        wall = evaluated(mi, plaster, x, np.array(700.0))
        assert np.abs(wall - 1.0).max() <= 0.03 + 1e-6


@pytest.mark.parametrize(("factor", "expected"), [(0.5, 0.3), (3.0, 1.0)])
def test_a_surface_is_its_colour_times_the_pattern_and_reflects_no_more_than_all(
    factor: float, expected: float
) -> None:
    with renderer(MONO) as mi:
        import drjit as dr  # noqa: PLC0415 -- only once Dr.Jit was told where LLVM is

        texture = mi.load_dict({"type": surface_plugin(mi.variant())})
        texture.show((0.6,), (200.0, 100.0), lambda x, y: factor + 0.0 * (x + y))
        si = dr.zeros(mi.SurfaceInteraction3f, 2)
        np.testing.assert_allclose(np.array(texture.eval(si)), expected, rtol=1e-6)
        places = []
        texture.show((0.6,), (200.0, 100.0), lambda x, y: places.append((x, y)) or x)
        si.uv = mi.Point2f([0.25, 1.0], [0.5, 1.0])
        texture.eval(si)
        np.testing.assert_allclose(np.array(places[0][0]), [50.0, 200.0])
        np.testing.assert_allclose(np.array(places[0][1]), [50.0, 100.0])
