"""The causes of residuals that simulation does not explain, by the order in which they explain most."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float64, Int64

from labcal.guide.twin.cause_designs import CauseKind, cause_design, pose_design
from labcal.guide.twin.residuals import DotResiduals, rms

_P = 1e-3
"""Probability of a gain by chance up to which a cause is named."""
_RCOND = 1e-9
_LEAST_SHARE = 0.01
"""Of the squares; what explains less is not worth a line."""
_LEAST_FREEDOM = 6


@dataclass(frozen=True)
class Cause:
    """One cause that residuals show.

    Attributes
    ----------
    kind : CauseKind
    share : float
        Of the squares of residuals, after the causes before it.
    parameters : int
    p_value : float
    size : float
        RMS displacement: of a print in its plane, and of a bend as it looks there, micrometres; else px.
    unit : str
        ``um`` or ``px``.
    fit : float64 array, (n, 2)
        What it takes of the residuals beyond the poses and the causes before it, px.
    """

    kind: CauseKind
    share: float
    parameters: int
    p_value: float
    size: float
    unit: str
    fit: Float64[np.ndarray, "n 2"]
    rivals: tuple[CauseKind, ...] = ()
    """Causes that would move the dots of these views alike, so that they do not tell which of them it is."""


@dataclass(frozen=True)
class Explained:
    """Shares of the squares of residuals.

    Attributes
    ----------
    noise : float
        What noise makes of them, by simulation; 1 at most.
    causes : tuple of Cause
        The one that explains most first.
    rest : float
        What neither explains.
    level : float
        Mean square of residuals in units of noise, the poses allowed for; 1 is noise alone.
    left_level : float
        The same after all causes.
    """

    noise: float
    causes: tuple[Cause, ...]
    rest: float
    level: float
    left_level: float


def explained(found: DotResiduals, dots: Float64[np.ndarray, "dots 3"], absorbed: float = 0.0) -> Explained:
    """Return what explains residuals: noise, and causes by forward selection.

    Parameters
    ----------
    found : DotResiduals
    dots : ndarray, shape (dots, 3)
        Places of the dots, mm.
    absorbed : float
        Degrees of freedom that went into the calibration from these same dots.

    Notes
    -----
    Linear models of the residuals, whitened by the noise, on top of small changes of the pose of each view.
    The cause with the best Bayesian information criterion (Schwarz 1978) enters first, while an F test finds
    its gain beyond chance. Another cause is a rival where the part of its fit that poses, causes before it
    and that other cause cannot follow is not beyond chance (chi-square test).
    A share is the gain less what so many parameters gain by noise.
    """
    model = _Model.of(found, dots)
    n = len(model.y)
    chosen: list[CauseKind] = []
    steps: list[tuple[CauseKind, float, int, float]] = []
    base, start = model.left(chosen)
    square, rank = base, start
    while best := _best(model, chosen, rank):
        kind, less, more = best
        gain, q = square - less, more - rank
        p = _chance(gain / q, less / (n - more), q, n - more)
        if not (p < _P and gain - q > _LEAST_SHARE * base):
            break
        steps.append((kind, (gain - q) / base, q, p))
        chosen, square, rank = [*chosen, kind], less, more
    fits = model.fits(chosen)
    causes = tuple(
        Cause(
            kind, share, q, p, *_size(kind, fits[kind], found), fits[kind], model.rivals(kind, chosen[:i], q)
        )
        for i, (kind, share, q, p) in enumerate(steps)
    )
    free = max(1.0, n - start - absorbed)
    noise = min(free / base, max(0.0, 1.0 - sum(cause.share for cause in causes)))
    rest = max(0.0, 1.0 - noise - sum(cause.share for cause in causes))
    return Explained(noise, causes, rest, base / free, square / max(1.0, n - rank - absorbed))


@dataclass(frozen=True)
class _Model:
    """Linear models of whitened residuals, by their normal equations."""

    y: Float64[np.ndarray, " rows"]
    X: Float64[np.ndarray, "rows columns"]
    gram: Float64[np.ndarray, "columns columns"]
    right: Float64[np.ndarray, " columns"]
    pose: Int64[np.ndarray, " some"]
    at: dict[CauseKind, np.ndarray]
    root: Float64[np.ndarray, "n 2 2"]

    @classmethod
    def of(cls, found: DotResiduals, dots: Float64[np.ndarray, "dots 3"]) -> "_Model":
        root = np.linalg.cholesky(found.covariance)
        white = np.linalg.inv(root)
        designs = [pose_design(found, dots), *(cause_design(kind, found, dots) for kind in CauseKind)]
        flat = [np.einsum("nij,njk->nik", white, X).reshape(2 * len(found), -1) for X in designs]
        flat = [X / np.maximum(np.linalg.norm(X, axis=0), 1e-12) for X in flat]
        edges = np.cumsum([0, *(X.shape[1] for X in flat)])
        places = [np.arange(first, end) for first, end in pairwise(edges)]
        X = np.concatenate(flat, axis=1)
        y = np.einsum("nij,nj->ni", white, found.residual).ravel()
        at = dict(zip(CauseKind, places[1:], strict=True))
        return cls(y, X, X.T @ X, X.T @ y, places[0], at, root)

    def _where(self, kinds: Sequence[CauseKind]) -> Int64[np.ndarray, " some"]:
        return np.concatenate([self.pose, *(self.at[kind] for kind in kinds)])

    def left(self, kinds: Sequence[CauseKind]) -> tuple[float, int]:
        """Return the sum of squares that poses and some causes leave, and the number of parameters."""
        where = self._where(kinds)
        size, axes = np.linalg.eigh(self.gram[np.ix_(where, where)])
        good = size > _RCOND * size.max()
        gained = ((axes[:, good].T @ self.right[where]) ** 2 / size[good]).sum()
        return max(float(self.y @ self.y - gained), 1e-12), int(good.sum())

    def _solved(self, where: Int64[np.ndarray, " some"], right: np.ndarray) -> np.ndarray:
        """Return coefficients of all columns, 0 but for some, from sums of products with what they fit."""
        size, axes = np.linalg.eigh(self.gram[np.ix_(where, where)])
        good = size > _RCOND * size.max()
        solved = np.zeros(len(self.gram))
        solved[where] = axes[:, good] @ ((axes[:, good].T @ right[where]) / size[good])
        return solved

    def rivals(self, kind: CauseKind, before: Sequence[CauseKind], q: int) -> tuple[CauseKind, ...]:
        """Return the causes that could make what a cause of q parameters makes, beside those before it."""
        from scipy.stats import chi2  # noqa: PLC0415 -- takes a second to import

        own, least = self.at[kind], float(chi2.isf(_P, q))
        made = np.zeros(len(self.gram))
        made[own] = self._solved(self._where([*before, kind]), self.right)[own]
        seen = self.gram @ made
        found = []
        for other in CauseKind:
            if other is not kind and other not in before:
                where = self._where([*before, other])
                left = made @ seen - seen[where] @ self._solved(where, seen)[where]
                if left < least:
                    found.append(other)
        return tuple(found)

    def fits(self, kinds: Sequence[CauseKind]) -> dict[CauseKind, Float64[np.ndarray, "n 2"]]:
        """Return what each of some causes takes of the residuals beyond poses and those before it, px.

        Fitted together, causes that few views hardly distinguish would be large and cancel.
        """
        found = {}
        before = self.X @ self._solved(self.pose, self.right)
        for number, kind in enumerate(kinds):
            taken = self.X @ self._solved(self._where(kinds[: number + 1]), self.right)
            found[kind] = np.einsum("nij,nj->ni", self.root, (taken - before).reshape(-1, 2))
            before = taken
        return found


def _best(model: _Model, chosen: list[CauseKind], rank: int) -> tuple[CauseKind, float, int] | None:
    """Return the cause that explains most for its parameters, what it leaves, and all parameters."""
    n = len(model.y)
    trials = []
    for kind in CauseKind:
        if kind not in chosen:
            less, more = model.left([*chosen, kind])
            if more > rank and n - more >= _LEAST_FREEDOM:
                trials.append((n * np.log(less / n) + more * np.log(n), kind, less, more))
    return min(trials)[1:] if trials else None


def _chance(gain: float, noise: float, q: int, freedom: int) -> float:
    from scipy.stats import f  # noqa: PLC0415 -- takes a second to import

    return float(f.sf(gain / max(noise, 1e-300), q, freedom))


def _size(kind: CauseKind, fit: Float64[np.ndarray, "n 2"], found: DotResiduals) -> tuple[float, str]:
    """Return the RMS displacement by a cause, and its unit."""
    if kind in {CauseKind.PRINT, CauseKind.BEND}:
        in_plane = np.einsum("nij,nj->ni", np.linalg.inv(found.by_point[:, :, :2]), fit)
        return 1e3 * rms(in_plane), "um"
    return rms(fit), "px"
