import pytest

from labcal.errors import InputError
from labcal.scene.catalogue import load_scene


@pytest.mark.parametrize("spp", [-64, 0, 70000])
def test_samples_that_cannot_be_are_refused(spp: int) -> None:
    with pytest.raises(InputError, match="spp"):
        load_scene("webcam-plane", (f"spp={spp}",))
