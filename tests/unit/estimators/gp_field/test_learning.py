"""Which round of learning camera and field is taken."""

import inspect
from types import SimpleNamespace

import numpy as np
import pytest

from labcal.estimators.gp_field import learning


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
    found = inspect.unwrap(learning._fitted)(None, None, None, None)  # without the checks of types
    assert found is (None if taken is None else ends[taken])
