"""Comparison of methods on one family of cameras with an oracle that knows the cameras."""

from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.bench.solve.families import FAMILIES, SIZE, Family
from labcal.cameras.triangulation import triangulate
from labcal.errors import InputError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.method_choice import estimator_of
from labcal.estimators.surrogate_validation import fit_unless_surrogate, surrogate_of, validate_on
from labcal.evaluate.statistics import coverage, error_statistics
from labcal.report.values import Measured
from labcal.rng import generator

NOISE_PX = 0.05
TESTS = 2000
RIGHT = "bundle (right family)"
METHODS = (
    RIGHT,
    "hybrid",
    "bundle",
    "two-plane",
    "ray-net",
    "mlp-bayes",
    "mlp",
    "dlt",
    "quadratic",
    "affine",
)


@dataclass(frozen=True)
class Comparison:
    """One comparison: a family, a seed and methods."""

    family: str
    seed: int
    methods: tuple[str, ...]
    own_code: tuple[str, ...] = ()
    """Digests of the modules of user methods: a method that was changed is measured again."""

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.family.replace(' ', '-')}-{self.seed}"


class MethodFigures(BaseModel):
    """Figures of one method; NaN if it refused the data."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    method: str
    ratio: Measured
    """RMS 3-D error over the oracle's."""
    coverage95: Measured
    misfit: bool
    """True if the method is flagged, from training data alone."""
    rehearsed_mm: Measured
    """RMS error predicted from training data alone."""
    refusal: str | None


class ComparisonFigures(BaseModel):
    """One family and seed."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    family: str
    seed: int
    oracle_mm: float
    methods: tuple[MethodFigures, ...]


def compared(comparison: Comparison) -> ComparisonFigures:
    """Return the figures of all methods on the same training dots and the same noisy test points."""
    family = next(one for one in FAMILIES if one.name == comparison.family)
    cameras = family.pair(comparison.seed)
    random = generator(comparison.seed, "bench solve", family.name)
    Y = family.volume.planes()
    p = family.volume.points(TESTS, random)
    X, q = (np.stack([camera.project(points).q for camera in cameras], axis=1) for points in (Y, p))
    seen = np.isfinite(X).all(axis=(1, 2))
    X, Y = (X + NOISE_PX * random.standard_normal(X.shape))[seen].reshape(int(seen.sum()), -1), Y[seen]
    seen = np.isfinite(q).all(axis=(1, 2))
    q, p = (q + NOISE_PX * random.standard_normal(q.shape))[seen], p[seen]
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(p), 2, 1, 1))
    oracle = error_statistics(triangulate(cameras, q, covariance).point, p).rmse_mm
    surrogate = surrogate_of(X, Y, (SIZE, SIZE))
    if surrogate is None:
        raise InputError(f"The training data of '{comparison.key}' determine no cameras to rehearse with.")
    figures = []
    for method in comparison.methods:
        estimator = _estimator(method, family, comparison.seed)
        if estimator is None:
            continue
        try:
            estimator = fit_unless_surrogate(surrogate, estimator, X, Y)
        except InputError as error:
            nan = float("nan")
            figures.append(
                MethodFigures(
                    method=method,
                    ratio=nan,
                    coverage95=nan,
                    misfit=True,
                    rehearsed_mm=nan,
                    refusal=str(error),
                )
            )
            continue
        found, stated = estimator.predict_with_covariance(q.reshape(len(q), -1), covariance)
        rehearsed = validate_on(estimator, surrogate)
        figures.append(
            MethodFigures(
                method=method,
                ratio=float(np.sqrt(((found - p) ** 2).sum(axis=1).mean())) / oracle,
                coverage95=coverage(found - p, stated),
                misfit=rehearsed.misfit,
                rehearsed_mm=rehearsed.rmse_mm,
                refusal=None,
            )
        )
    return ComparisonFigures(
        family=comparison.family, seed=comparison.seed, oracle_mm=oracle, methods=tuple(figures)
    )


def _estimator(method: str, family: Family, seed: int) -> PointEstimator | None:
    """Return a new estimator; None if a family has no correct one."""
    estimator = estimator_of("bundle" if method == RIGHT else method)
    if method == RIGHT:
        if family.right is None:
            return None
        estimator.set_params(**family.right)
    known = estimator.get_params()
    if "image_sizes" in known:
        estimator.set_params(image_sizes=(SIZE, SIZE))
    if "random_state" in known:
        estimator.set_params(random_state=seed)
    return estimator
