"""Mistakes as terms of a model: what each lets differ between views."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.forms.model import Term
from labcal.guide.diagnosis.forms.picture_forms import BENT, STRETCH
from labcal.guide.diagnosis.forms.view_forms import ViewForms

FEWEST = 2
"""Views before and after a change, at least."""
PAIR = 2
"""Cameras with one pose between them, of which nothing tells which one moved."""


@dataclass(frozen=True)
class Hypothesis:
    """A mistake that is one of several alternatives of its kind.

    Attributes
    ----------
    check : CheckName
    camera : int or None
        The camera that it concerns; None for all.
    views : tuple of int
        Views that it concerns: after a change those from it on; empty for all.
    terms : tuple of Term
    alternatives : int
        Number of the hypotheses of this kind, of which the best is taken.
    """

    check: CheckName
    camera: int | None
    views: tuple[int, ...]
    terms: tuple[Term, ...]
    alternatives: int


def base_terms(forms: ViewForms) -> tuple[Term, ...]:
    """Return the model of a shoot without mistakes, camera by camera in the order of ``rig.json``."""
    everywhere = np.zeros(forms.views, dtype=np.int64)
    terms = []
    for camera in range(len(forms.cameras)):
        terms.append(Term(unit_columns(forms, forms.lens_of(camera)), everywhere))
        if camera:
            terms.append(Term(unit_columns(forms, forms.pose(camera)), everywhere))
    return tuple(terms)


def free_poses(forms: ViewForms) -> tuple[Term, ...]:
    """Return terms by which every camera sees the target in a pose of its own in each view."""
    return tuple(
        Term(unit_columns(forms, forms.pose(camera)), _numbered(forms.dots[camera] > 0))
        for camera in range(1, len(forms.cameras))
    )


def each_focus(forms: ViewForms, camera: int) -> Term:
    """Return a term by which a camera has a focal length and a principal point of its own in each view."""
    return Term(focus_columns(forms, camera), _numbered(forms.dots[camera] > 0))


def shape_controls(forms: ViewForms) -> Term:
    """Return the smooth shapes that are neither a bend nor a stretch."""
    columns = np.arange(forms.shape.start + STRETCH + BENT, forms.shape.stop)
    return Term(_unit(forms, columns), np.zeros(forms.views, dtype=np.int64))


def hypotheses(forms: ViewForms) -> Iterator[Hypothesis]:
    """Yield the mistakes that a shoot may have."""
    yield from _of_board(forms)
    yield from _of_cameras(forms)
    yield from _of_views(forms)


def changes(forms: ViewForms, after: Int64[np.ndarray, " views"]) -> Iterator[Hypothesis]:
    """Yield changes of a camera at one view, from a grouping of views by changes that are known already.

    Parameters
    ----------
    forms : ViewForms
    after : ndarray, shape (views,)
        Zeros, or 1 from a view on at which something has changed already.
    """
    starts = [
        view for view in range(FEWEST, forms.views - FEWEST + 1) if not np.diff(after)[view - 1 : view].any()
    ]
    cameras = len(forms.cameras)
    posed = range(1, cameras) if cameras == PAIR else range(cameras)
    for start in starts:
        groups = np.where(np.arange(forms.views) >= start, 0, -1)
        later = tuple(range(start, forms.views))
        for camera in posed if cameras > 1 else ():
            term = Term(unit_columns(forms, forms.pose(camera)), groups)
            yield Hypothesis(CheckName.CAMERA_MOVED, camera, later, (term,), len(starts) * len(posed))
        for camera in range(cameras):
            term = Term(focus_columns(forms, camera), groups)
            yield Hypothesis(CheckName.REFOCUSED, camera, later, (term,), len(starts) * cameras)


def _of_cameras(forms: ViewForms) -> Iterator[Hypothesis]:
    yield from changes(forms, np.zeros(forms.views, dtype=np.int64))


def _of_board(forms: ViewForms) -> Iterator[Hypothesis]:
    everywhere = np.zeros(forms.views, dtype=np.int64)
    first = forms.shape.start
    bent = _unit(forms, np.arange(first + STRETCH, first + STRETCH + BENT))
    yield Hypothesis(CheckName.BENT_BOARD, None, (), (Term(bent, everywhere),), 1)
    stretched = _unit(forms, np.arange(first, first + STRETCH))
    yield Hypothesis(CheckName.WRONG_PITCH, None, (), (Term(stretched, everywhere),), 1)


def _of_views(forms: ViewForms) -> Iterator[Hypothesis]:
    cameras = range(len(forms.cameras))
    for camera in cameras:
        seen = _numbered(forms.dots[camera] > 0)
        term = Term(unit_columns(forms, forms.rows_of(camera)), seen)
        yield Hypothesis(CheckName.ROLLING_SHUTTER, camera, (), (term,), len(cameras) + 1)
    if len(cameras) > 1:
        everywhere = np.arange(forms.views, dtype=np.int64)
        term = Term(_rows_together(forms), everywhere)
        yield Hypothesis(CheckName.ROLLING_SHUTTER, None, (), (term,), len(cameras) + 1)
    for camera in cameras[1:]:
        seen = np.flatnonzero(forms.dots[camera] > 0)
        columns = unit_columns(forms, forms.pose(camera))
        yield Hypothesis(
            CheckName.UNSYNCHRONISED,
            camera,
            (),
            (Term(columns, _numbered(forms.dots[camera] > 0)),),
            len(seen),
        )
        for view in seen.tolist():
            groups = np.full(forms.views, -1, dtype=np.int64)
            groups[view] = 0
            yield Hypothesis(CheckName.UNSYNCHRONISED, camera, (view,), (Term(columns, groups),), len(seen))


def focus_columns(forms: ViewForms, camera: int) -> Float64[np.ndarray, "columns 3"]:
    """Return the columns of a change of the focal length, relative, and of the principal point, px."""
    K = forms.cameras[camera].single.camera.K
    columns = np.zeros((forms.products.shape[1] - 1, 3))
    first = forms.lens_of(camera).start
    columns[first : first + 2, 0] = K[0, 0], K[1, 1]
    columns[first + 2, 1] = columns[first + 3, 2] = 1.0
    return columns


def _rows_together(forms: ViewForms) -> Float64[np.ndarray, "columns 6"]:
    """Return the columns of a motion of the target while all cameras read their rows, in the world's axes."""
    columns = np.zeros((forms.products.shape[1] - 1, 6))
    for camera, T_cam_world in enumerate(forms.T_cam_world):
        first = forms.rows_of(camera).start
        columns[first : first + 3, :3] = columns[first + 3 : first + 6, 3:] = T_cam_world[:3, :3]
    return columns


def unit_columns(forms: ViewForms, columns: slice) -> Float64[np.ndarray, "columns k"]:
    """Return the columns of a slice by themselves."""
    return _unit(forms, np.arange(columns.start, columns.stop))


def any_shape(forms: ViewForms) -> Term:
    """Return all smooth shapes of the board: an uneven print, a bend, and a stretch."""
    return Term(unit_columns(forms, forms.shape), np.zeros(forms.views, dtype=np.int64))


def _unit(forms: ViewForms, columns: np.ndarray) -> Float64[np.ndarray, "columns k"]:
    found = np.zeros((forms.products.shape[1] - 1, len(columns)))
    found[columns, np.arange(len(columns))] = 1.0
    return found


def _numbered(seen: np.ndarray) -> Int64[np.ndarray, " views"]:
    """Return numbers of the views that are seen, from 0; -1 for the others."""
    return np.where(seen, np.cumsum(seen) - 1, -1).astype(np.int64)
