"""Marks as points: one small specimen against its truth."""

import numpy as np

from labcal.bench.marks.in_space import measured
from labcal.bench.marks.specimen import specimen
from labcal.distributions import chi2_quantile


def test_every_mark_of_a_specimen_is_a_point_at_its_place() -> None:
    made = specimen(2, 0, 4, 3)
    found = measured(made)
    names = [name for name, _, _ in found]
    assert set(made.named) <= set(names)
    assert sum(name.startswith("dot-") for name in names) == len(made.plain)
    error = np.array([off for _, off, _ in found])
    covariance = np.array([stated for _, _, stated in found])
    squares = (error * np.linalg.solve(covariance, error[..., None])[..., 0]).sum(axis=1)
    assert np.linalg.norm(error, axis=1).max() < 0.5
    assert (squares < chi2_quantile(1.0 - 1e-4, 3)).all()
