import pytest

from labcal.errors import InputError
from labcal.scene.catalogue import load_scene
from labcal.scene.model import samples_per_pass


@pytest.mark.parametrize(
    ("spp", "samples"), [(1, 1), (2, 2), (4, 4), (8, 8), (16, 16), (32, 16), (48, 16), (64, 64), (256, 64)]
)
def test_samples_are_split_into_equal_passes(spp: int, samples: int) -> None:
    assert samples_per_pass(spp) == samples


@pytest.mark.parametrize("spp", [-64, 0, 3, 12, 37, 100])
def test_samples_that_no_passes_make_up_are_refused(spp: int) -> None:
    with pytest.raises(InputError, match="multiple of 16"):
        load_scene("webcam-plane").with_spp(spp)
