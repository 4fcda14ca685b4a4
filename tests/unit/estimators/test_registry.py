import pytest

from labcal.errors import UnknownNameError
from labcal.estimators.registry import make_estimator, method_class, method_names


def test_every_method_is_made_under_its_own_name() -> None:
    assert method_names() == [
        "affine", "bundle", "dlt", "homography", "hybrid",
        "mlp", "mlp-bayes", "quadratic", "ray-net", "two-plane",
    ]  # fmt: skip
    for name in method_names():
        assert make_estimator(name).method == name
        assert type(make_estimator(name)) is method_class(name)


def test_a_misspelled_name_gets_the_nearest_one() -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'homography'"):
        make_estimator("homografy")
