"""Marks beside a grid of equal dots: letters, logos and rulers about a step outside are no dots of it."""

from collections.abc import Sequence

import numpy as np

from labcal.arrays import DotIndices, Mask
from labcal.detect.checks.missing_dots import UnmeasuredDot
from labcal.detect.lattice.dot_shapes import shape_deviations
from labcal.detect.lattice.lattice import Lattice, find_lattices
from labcal.detect.lattice.lines_seen import lines_words, where_words
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.lattice.rings import ring_nodes
from labcal.detect.lattice.rough_undistortion import NONE
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings
from labcal.geometry.two_by_two import eigenvalues, inverses
from labcal.targets.grid import DotGrid, Layout
from labcal.wording import counted


def without_marks_beside(
    lattice: Lattice, outlines: Outlines, target: DotGrid, settings: GridSettings
) -> Lattice:
    """Return a lattice without outermost lines that hold hardly a dot.

    An outermost row or column goes where its spots that look like dots, of the shape of the others and
    without a hole, are fewer than half of the line inside it. A line of which that is true is none that a
    plain grid could be numbered by.

    Parameters
    ----------
    lattice : Lattice
    outlines : Outlines
        In the picture of the lattice's lens.
    target : DotGrid
        One without rings.
    settings : GridSettings
    """
    spots = np.array(list(lattice.spots.values()))
    places = _places(np.array(list(lattice.spots), dtype=np.int64), target)
    like = _like_dots(lattice, outlines, target, settings)
    kept = np.ones(len(spots), dtype=bool)
    changed = True
    while changed and kept.sum() > settings.min_dots:
        changed = False
        for axis in (0, 1):
            values = np.unique(places[kept, axis])
            if len(values) < 3:  # noqa: PLR2004 -- a line with one inside it, and one opposite
                continue
            for outer, inner in ((values[0], values[1]), (values[-1], values[-2])):
                line = kept & (places[:, axis] == outer)
                beside = int((kept & (places[:, axis] == inner)).sum())
                if (line & like).sum() < settings.edge_line_share * beside:
                    kept &= ~line
                    changed = True
    if kept.all() or kept.sum() <= settings.min_dots:
        return lattice
    return Lattice(
        {node: spot for (node, spot), keep in zip(lattice.spots.items(), kept, strict=True) if keep},
        lattice.undistortion,
    )


def dots_among(
    unmeasured: Sequence[UnmeasuredDot], predictor: Predictor, outlines: Outlines, settings: GridSettings
) -> list[UnmeasuredDot]:
    """Return those of the dots that are not measured which look like dots, as far as they are seen whole.

    Parameters
    ----------
    unmeasured : sequence of UnmeasuredDot
    predictor : Predictor
        Of the lattice.
    outlines : Outlines
        All of the picture, which tell holes.
    settings : GridSettings
    """
    expected = predictor.predict([dot.node for dot in unmeasured])
    found = []
    for dot in unmeasured:
        prediction = expected.get(dot.node)
        if prediction is None or not np.isfinite(dot.outline).all():
            found.append(dot)
            continue
        relative = np.sqrt(np.abs(eigenvalues(inverses(prediction.outline[None]) @ dot.outline[None])[0]))
        minor = float(np.sqrt(eigenvalues(dot.outline[None])[0, 0]))
        off = float(np.abs(np.log(relative)).max()) - settings.shape_px / minor
        distance = np.linalg.norm(outlines.centre - dot.seen_at, axis=1)
        nearest = int(distance.argmin()) if len(distance) else -1
        holed = (
            nearest >= 0
            and distance[nearest] < outlines.radius[nearest]
            and outlines.hole[nearest] > settings.ring_hole_share
        )
        if off <= settings.max_mark_shape_log and not holed:
            found.append(dot)
    return found


def lines_seen(outlines: Outlines, target: DotGrid, settings: GridSettings) -> str:
    """Return how many columns and rows of dots are in a picture and where, as a sentence; or nothing.

    Parameters
    ----------
    outlines : Outlines
        Candidates that lie whole in the picture.
    target : DotGrid
    settings : GridSettings
    """
    found = find_lattices(outlines, target, NONE, settings)
    if not found:
        return ""
    lattice = found[0]
    if target.rings is None:
        lattice = without_marks_beside(lattice, outlines, target, settings)
    q = outlines.centre[list(lattice.spots.values())]
    if target.layout is Layout.ASYMMETRIC:
        return f"{len(q)} dots of a grid were seen {where_words(q)}; the target has {target.count}."
    nodes = np.array(list(lattice.spots), dtype=np.int64)
    words = lines_words(nodes, q, "dots", (target.cols, target.rows))
    if target.rings is None:
        return words
    rings = len(ring_nodes(lattice, outlines, settings))
    return f"{words} {counted(rings, 'ring')} {'was' if rings == 1 else 'were'} seen among them."


def _places(nodes: DotIndices, target: DotGrid) -> DotIndices:
    """Return nodes by column and row; of an asymmetric grid, whose lattice stands on a corner, in halves."""
    if target.layout is Layout.SYMMETRIC:
        return nodes
    return np.stack([nodes[:, 0] - nodes[:, 1], nodes[:, 0] + nodes[:, 1]], axis=-1)


def _like_dots(lattice: Lattice, outlines: Outlines, target: DotGrid, settings: GridSettings) -> Mask:
    """Tell which spots of a lattice look like dots: of the usual shape, without a hole."""
    off = shape_deviations(Predictor(lattice, outlines, settings), outlines, target, settings)
    holed = outlines.hole[list(lattice.spots.values())] > settings.ring_hole_share
    return np.asarray((off <= settings.max_mark_shape_log) & ~holed)
