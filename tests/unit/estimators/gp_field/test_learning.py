"""Which round of learning camera and field is taken."""

import inspect
from types import SimpleNamespace

import numpy as np
import pytest

from labcal.bench.distortion.case import Case, Cell, Layout
from labcal.bench.distortion.cell_data import cell_data
from labcal.bench.families.cameras import PERIOD_PX, SIZE
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import resect
from labcal.estimators.gp_field import learning
from labcal.estimators.gp_field.fitted_camera import Asked


def rounds(*fields: tuple[float, float]) -> list[SimpleNamespace]:
    """Return rounds whose fields have these sizes and likelihoods."""
    return [
        SimpleNamespace(
            restricted=likelihood,
            fitted=SimpleNamespace(field=SimpleNamespace(smoothed=lambda size=size: np.full((4, 2), size))),
        )
        for size, likelihood in fields
    ]


@pytest.mark.parametrize(
    ("fields", "taken"),
    [
        (((1.0, 9.0), (1.1, 8.0), (1.11, 7.0)), 2),  # come to rest: the last
        (((49.0, 9.0), (199.0, 7.0), (122.0, 8.0)), 0),  # drifting: the likeliest
        (((49.0, 7.0), (199.0, 9.0), (122.0, 8.0)), 1),
        (((49.0, 7.0), (49.0, 9.0)), None),  # the third calls for no field
    ],
)
def test_rounds_that_do_not_come_to_rest_are_judged_by_likelihood(
    fields: tuple[tuple[float, float], ...], taken: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    ends = rounds(*fields)
    monkeypatch.setattr(learning, "_rounds", lambda *_: iter(ends))
    found = inspect.unwrap(learning._fitted)(None, None, None)  # without the checks of types
    assert found is (None if taken is None else ends[taken])


@pytest.mark.parametrize(("noise_px", "seed"), [(0.02, 11), (0.1, 1)], ids=["missed", "as likely as none"])
def test_waves_that_show_only_where_light_arrives_are_found(noise_px: float, seed: int) -> None:
    """Strong ones: as a function of where light would have arrived, they have harmonics."""
    data = cell_data(Case(Cell("wavy-pane", 1.0, noise_px, 140, Layout.PLANES), seed, (), (), 0))
    q, p = data.X[:, :2], data.Y
    start = resect("test", q, p, camera_of_lens("pinhole", SIZE, None))
    fitted = learning.fitted_camera(start, q, p).fitted
    assert fitted is not None
    assert fitted.asked is Asked.ARRIVED
    period = 2.0 * np.pi * SIZE[0] / fitted.field.scale.kernel.wavenumber
    assert period == pytest.approx(PERIOD_PX, rel=0.01)
