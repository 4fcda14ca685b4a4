"""Numbering of a lattice, whatever the target marks its dots with."""

from collections.abc import Sequence

from labcal.detect.flags import Refusal
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.plain import DiagonalNumbering, number_plain
from labcal.detect.lattice.rings import Numbering, number_by_rings
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings
from labcal.targets.grid import DotGrid

AnyNumbering = Numbering | DiagonalNumbering
"""Map from a lattice node to its (col, row)."""


def number_lattice(
    lattice: Lattice, outlines: Outlines, target: DotGrid, settings: GridSettings
) -> AnyNumbering | Refusal:
    """Find ids for a lattice by the target's rings or, where its dots are all alike, by its edges.

    Returns
    -------
    AnyNumbering or Refusal
        See :func:`labcal.detect.lattice.rings.number_by_rings` and
        :func:`labcal.detect.lattice.plain.number_plain`.
    """
    if target.rings is None:
        return number_plain(lattice, outlines, target, settings)
    return number_by_rings(lattice, outlines, target, target.rings, settings)


def numbering_refusal(outcomes: Sequence[AnyNumbering | Refusal], target: DotGrid) -> Refusal | None:
    """Return the reason why a picture with these lattices has no ids; None if exactly one has a numbering."""
    refusals = {outcome for outcome in outcomes if isinstance(outcome, Refusal)}
    named = sum(not isinstance(outcome, Refusal) for outcome in outcomes)
    if target.rings is None:
        if named > 1:
            return Refusal.SEVERAL_TARGETS
        return None if named == 1 else Refusal.AMBIGUOUS
    if named > 1 or Refusal.AMBIGUOUS_RINGS in refusals:
        return Refusal.AMBIGUOUS_RINGS
    if named == 1:
        return None
    return Refusal.MIRRORED if Refusal.MIRRORED in refusals else Refusal.NO_RINGS
