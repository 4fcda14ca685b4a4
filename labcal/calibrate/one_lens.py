"""Test whether all pictures of a camera were taken through one lens.

Each view tells by which change of the lens it would be explained better than by the common calibration. Views
of one camera scatter about no change at all, as far as each is sure of it. Of two cameras that were taken for
one, or of a camera that was refocused, they fall into two groups that stand apart.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64

from labcal.calibrate.adjustment.blocks import assemble
from labcal.calibrate.adjustment.free_dots import adjust_dots
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.rounds import Adjusted, adjust_in_rounds
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.errors import InputError
from labcal.optim.robust import SQUARES
from labcal.optim.stopping import StopReason
from labcal.targets.catalogue import AnyTarget

FEWEST = 2
"""Views of a group, and in another group than all others."""
LEAST_GAIN, LEAST_SHARE, LEAST_RATIO, SURE_RATIO = 60.0, 0.02, 15.0, 30.0
"""A second lens is believed in from where it takes so much off the cost (squares in units of their variance),
that share of it, and so many times what yet another lens a view would, number by number. It has to be more
where the print may be uneven or bent, which also makes views differ."""
_SUSPECT = 3.0
"""The last one, from which on it is worth a closer look."""
_UNEVEN = 5.0
"""Times their own noise: where dots scatter by so much, a print may hide that views differ."""
_NARROW = ("pinhole", "brown-k1k2")
"""Lens models that may not suit, which also makes views differ; brown5 is the next larger one."""
_TELLS = 0.02
"""Share of the mean information of a view above which a direction of the lens parameters is determined."""
_AXES, _AROUND, _STEPS = 6, 16, 20


@dataclass(frozen=True)
class TwoLenses:
    """Views that a second lens explains far better.

    Attributes
    ----------
    groups : two tuples of str
        Names of the views; the first one's group comes first.
    share : float
        Decrease of the sum of squares by the second lens.
    ratio : float
        This decrease over that by a further lens for each view, per parameter.
    """

    groups: tuple[tuple[str, ...], tuple[str, ...]]
    share: float
    ratio: float


@dataclass(frozen=True)
class _Votes:
    """Quadratic forms of views in a lens change d: it decreases their cost by ``2 b'd - d'A d``."""

    A: Float64[np.ndarray, "views n n"]
    b: Float64[np.ndarray, "views n"]

    def best(self, group: Bool[np.ndarray, " views"]) -> Float64[np.ndarray, " n"]:
        """Return the change that suits a group best."""
        held = 1e-9 * np.eye(self.b.shape[1])  # of what the group does not tell at all
        return np.asarray(np.linalg.solve(self.A[group].sum(axis=0) + held, self.b[group].sum(axis=0)))

    def gains(self, change: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " views"]:
        """Return the decrease of the cost of every view by a change."""
        return np.asarray(2.0 * self.b @ change - np.einsum("i,vij,j->v", change, self.A, change))

    def gain(self, group: Bool[np.ndarray, " views"]) -> float:
        """Return the decrease of the total cost by one lens for a group and another for the rest."""
        return float(sum(self.gains(self.best(part))[part].sum() for part in (group, ~group)))

    def left(self, group: Bool[np.ndarray, " views"]) -> tuple[float, int]:
        """Return the further decrease by a lens for every view, and its number of parameters."""
        gain, numbers = 0.0, 0
        for part in (group, ~group):
            b = self.b[part] - self.A[part] @ self.best(part)
            curvature, axes = np.linalg.eigh(self.A[part])
            along = np.einsum("vij,vi->vj", axes, b)
            determined = curvature > _TELLS
            gain += float((along[determined] ** 2 / curvature[determined]).sum())
            numbers += int(determined.sum()) - self.b.shape[1]
        return gain, numbers


def two_lenses(
    adjusted: Adjusted,
    observations: Observations,
    views: tuple[str, ...],
    target: AnyTarget,
    eccentricity_rounds: int,
) -> TwoLenses | None:
    """Return two groups of one camera's views that were taken through different lenses, or None.

    Where views differ, or dots scatter by far more than their noise, they are looked at once more: with a
    lens model that surely suits, and with the dots where they are on the print.

    Parameters
    ----------
    adjusted : Adjusted
        Of one camera, its lens free.
    observations : Observations
        Those that were adjusted: centroids.
    views : tuple of str
        Names, in the order of their numbers.
    target : AnyTarget
    eccentricity_rounds : int
        As in :func:`~labcal.calibrate.adjustment.rounds.adjust_in_rounds`.
    """
    if adjusted.reason is StopReason.EPOCHS:  # views differ in what is left of the way, too
        return None
    found = apart(adjusted, observations, views)
    variances = np.trace(observations.covariance, axis1=1, axis2=2)
    uneven = adjusted.scatter_px > _UNEVEN * np.sqrt(0.5 * np.median(variances))
    if not uneven and (found is None or found.ratio < _SUSPECT):
        return None
    least = LEAST_RATIO
    suspect = found is not None and found.ratio >= _SUSPECT
    narrow = suspect and adjusted.state.cameras[0].lens in _NARROW
    if narrow or not adjusted.layout.freedom.dots.shape[1]:
        try:
            flat = (
                _with_larger_lens(adjusted, observations, target, eccentricity_rounds) if narrow else adjusted
            )
            free = adjust_dots(flat, observations, target, Lenses.FREE, eccentricity_rounds)
            adjusted, observations = free.adjusted, free.observations
        except InputError:
            least = SURE_RATIO  # the dots cannot be freed, and the print may be what makes views differ
        found = apart(adjusted, observations, views)
    return None if found is None or found.ratio < least else found


def _with_larger_lens(
    adjusted: Adjusted, observations: Observations, target: AnyTarget, eccentricity_rounds: int
) -> Adjusted:
    """Return the adjustment with a lens model that is not too simple, and the dots as declared."""
    (camera,) = adjusted.state.cameras
    lens = "brown5" if camera.lens in _NARROW else camera.lens
    state = RigState((replace(camera, lens=lens),), adjusted.state.T_world_target, target.points())
    freedom = Freedom(Lenses.FREE, np.zeros((state.dots.size, 0)))
    return adjust_in_rounds(
        state, observations, freedom, 0.5 * target.outer_diameters_mm(), eccentricity_rounds
    )


def apart(adjusted: Adjusted, observations: Observations, views: tuple[str, ...]) -> TwoLenses | None:
    """Return the two groups of views that differ most; None where that is no more than chance makes them."""
    dots = observations.moved(-adjusted.eccentricity).scattered(adjusted.scatter_px**2)
    votes = _votes(adjusted.state, dots.where(~adjusted.outlier), len(views))
    if votes is None or len(views) < 2 * FEWEST:
        return None
    group = max(_groups(votes), key=votes.gain, default=None)
    if group is None:
        return None
    gain = votes.gain(group) - votes.gain(np.ones(len(views), dtype=bool))
    more, numbers = votes.left(group)
    white = dots.whitener.whiten(adjusted.residual.T).T[~adjusted.outlier]
    share = gain / float((white**2).sum())
    ratio = (gain / votes.b.shape[1]) / max(more / max(numbers, 1), 1.0)
    if numbers < 1 or gain < LEAST_GAIN or share < LEAST_SHARE:
        return None
    first = group if group[0] else ~group
    names = np.array(views)
    return TwoLenses((tuple(names[first].tolist()), tuple(names[~first].tolist())), share, ratio)


def _votes(state: RigState, dots: Observations, views: int) -> _Votes | None:
    """Return the form of each view, with its pose eliminated; None if it is not determined."""
    freedom = Freedom(Lenses.FREE, np.zeros((state.dots.size, 0)))
    A, b = [], []
    for view in range(views):
        own = dots.where(dots.view == view)
        own = replace(own, view=np.zeros_like(own.view))
        alone = Layout(RigState(state.cameras, state.T_world_target[view : view + 1], state.dots), freedom)
        blocks = assemble(alone, own, SQUARES)
        try:
            follows = blocks.cross[0] @ np.linalg.inv(blocks.view[0])
        except np.linalg.LinAlgError:
            return None
        A.append(blocks.shared - follows @ blocks.cross[0].T)
        b.append(follows @ blocks.gradient.view[0] - blocks.gradient.shared)
    try:
        root = np.linalg.inv(np.linalg.cholesky(np.mean(A, axis=0)))
    except np.linalg.LinAlgError:
        return None
    votes = _Votes(root @ np.array(A) @ root.T, np.array(b) @ root.T)
    return votes if np.isfinite(votes.A).all() and np.isfinite(votes.b).all() else None


def _groups(votes: _Votes) -> Iterator[Bool[np.ndarray, " views"]]:
    """Return ways to split the views in two, each with its views where they are explained best."""
    views, n = votes.b.shape
    for start in _starts(np.linalg.solve(votes.A + 0.3 * np.eye(n), votes.b[..., None])[..., 0]):
        group = start
        for _ in range(_STEPS):
            if not FEWEST <= group.sum() <= views - FEWEST:
                break
            moved = votes.gains(votes.best(group)) > votes.gains(votes.best(~group))
            if (moved == group).all():
                break
            group = moved
        if FEWEST <= group.sum() <= views - FEWEST:
            yield group


def _starts(changes: Float64[np.ndarray, "views n"]) -> Iterator[Bool[np.ndarray, " views"]]:
    """Return first splits: along what views' own changes differ in most, and around every view."""
    _, _, axes = np.linalg.svd(changes - np.median(changes, axis=0), full_matrices=False)
    for axis in axes[:_AXES]:
        along = changes @ axis
        order = np.sort(along)
        gap = FEWEST - 1 + int(np.argmax(np.diff(order)[FEWEST - 1 : len(order) - FEWEST]))
        yield along > 0.5 * (order[gap] + order[gap + 1])
        yield along > np.median(along)
    for change in changes[:: -(-len(changes) // _AROUND)]:
        away = ((changes - change) ** 2).sum(axis=1)
        yield away <= np.median(away)
