"""Least squares of the dots of a shoot by terms that all views, some views, or each view has."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.guide.diagnosis.forms.view_forms import ViewForms

_OPEN = 1e-10
"""Share of the largest eigenvalue, of scaled normal equations, below which a direction is open."""


@dataclass(frozen=True)
class Term:
    """Parameters of a model, the same in all views of a group.

    Attributes
    ----------
    columns : float64 array, (columns, k)
        Columns of the views' forms that each parameter moves, but for the last one.
    groups : int64 array, (views,)
        Number of the group of each view, from 0; -1 where the term has no part.
    """

    columns: Float64[np.ndarray, "columns k"]
    groups: Int64[np.ndarray, " views"]

    @property
    def count(self) -> int:
        """Number of parameters."""
        return int(self.columns.shape[1]) * (1 + int(self.groups.max()))


@dataclass(frozen=True)
class Fit:
    """Least squares of a model.

    Attributes
    ----------
    chi2 : float
        What is left, in units of variances.
    freedom : int
        Number of parameters that the dots determine.
    values : float64 array, (parameters,)
        Term after term, and of each group after group.
    covariance : float64 array, (parameters, parameters)
        In units of the stated variances.
    """

    chi2: float
    freedom: int
    values: Float64[np.ndarray, " parameters"]
    covariance: Float64[np.ndarray, "parameters parameters"]


def fitted(forms: ViewForms, terms: Sequence[Term]) -> Fit:
    """Return the least squares of some terms."""
    starts = np.cumsum([0, *(term.count for term in terms)]).tolist()
    normal, right, square = np.zeros((starts[-1],) * 2), np.zeros(starts[-1]), 0.0
    for view, products in enumerate(forms.products):
        square += float(products[-1, -1])
        own = [
            (start + term.groups[view] * term.columns.shape[1], term.columns)
            for start, term in zip(starts[:-1], terms, strict=True)
            if term.groups[view] >= 0
        ]
        at = np.concatenate([np.arange(first, first + columns.shape[1]) for first, columns in own])
        moves = np.concatenate([columns for _, columns in own], axis=1)
        normal[np.ix_(at, at)] += moves.T @ products[:-1, :-1] @ moves
        right[at] -= moves.T @ products[:-1, -1]
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(normal), 1e-300))
    values, axes = np.linalg.eigh(normal * np.outer(scale, scale))
    known = values > _OPEN * values[-1]
    axes, values = axes[:, known], values[known]
    along = axes.T @ (scale * right)
    root = scale[:, None] * axes / np.sqrt(values)
    solution = scale * (axes @ (along / values))
    chi2 = max(0.0, square - float((along**2 / values).sum()))
    return Fit(chi2, int(known.sum()), solution, root @ root.T)


def moved_by(
    views: int, terms: Sequence[Term], values: Float64[np.ndarray, " parameters"]
) -> Float64[np.ndarray, "views columns"]:
    """Return what values of some terms move each column by, view by view."""
    moved = np.zeros((views, len(terms[0].columns)))
    start = 0
    for term in terms:
        own = values[start : start + term.count].reshape(-1, term.columns.shape[1])
        seen = term.groups >= 0
        moved[seen] += own[term.groups[seen]] @ term.columns.T
        start += term.count
    return moved
