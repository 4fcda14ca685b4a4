"""Settings of stage 2: from outlines to a lattice, and from a lattice to a numbered grid."""

from typing import Annotated, ClassVar

from pydantic import Field, model_validator

from labcal.detect.stage_settings.stage import StageSettings

_Degrees = Annotated[float, Field(gt=1, lt=360)]
_Nodes = Annotated[int, Field(ge=1, le=20)]


class GridSettings(StageSettings):
    """Settings of the grid. A step is the distance to the next node there, in the picture."""

    stage: ClassVar[str] = "grid"

    min_dots: int = Field(
        9, ge=4, le=1000, description="Fewest dots of a grid. Larger: small parts are refused."
    )
    complete_share: float = Field(
        0.97,
        gt=0,
        le=1,
        description="Part of the outlines of a dot's size that a grid holds if nothing is missed. Larger: "
        "wide lenses are tried more often.",
    )
    similar_radius_share: float = Field(
        0.2,
        ge=0,
        lt=1,
        description="How far beyond the dots' radii an outline still has a dot's size. Larger: slower.",
    )
    fisheye_fields_deg: tuple[_Degrees, ...] = Field(
        (100.0, 140.0, 170.0),
        max_length=20,
        description="Diagonal fields of view of the equidistant fisheyes that are tried. More: slower, "
        "more wide lenses.",
    )
    # Seeds: crosses from which a lattice grows.
    max_outlines: int = Field(
        4000,
        ge=9,
        le=1_000_000,
        description="Outlines looked at, the largest first. Larger: slower in clutter.",
    )
    max_seeds: int = Field(600, ge=1, le=1_000_000, description="Seeds tried. Larger: slower in clutter.")
    max_lattices: int = Field(
        12, ge=1, le=1000, description="Lattices grown in a picture. Larger: slower in clutter."
    )
    seed_neighbours: int = Field(
        24, ge=5, le=1000, description="Outlines looked at around a seed. Larger: slower, bears more clutter."
    )
    min_seed_neighbours: int = Field(
        5,
        ge=3,
        le=1000,
        description="Fewest outlines around a seed. Larger: narrow parts of a grid are lost.",
    )
    seed_radius_log: float = Field(
        0.7,
        gt=0,
        le=5,
        description="Most difference of log radii around a seed. Larger: steeper perspective, more clutter.",
    )
    seed_shape_log: float = Field(
        0.35,
        gt=0,
        le=1,
        description="Most cosine between the arms of a cross, and difference of the log ratio of its steps "
        "from the target's. Larger: more seeds, more wrong ones.",
    )
    seed_residual_steps: float = Field(
        0.15,
        gt=0,
        lt=0.5,
        description="Most distance of a spot from its place in the cross. Larger: more wrong seeds.",
    )
    good_seed_steps: float = Field(
        0.06,
        gt=0,
        lt=0.5,
        description="A seed that fits so well is grown at once. Larger: worse seeds grow first.",
    )
    seed_cell_factor: float = Field(
        1.3,
        ge=1,
        le=4,
        description="Cells up to so many times the smallest compete by their fit. Larger: coarser cells.",
    )
    # Growth: nodes predicted by the nodes around them.
    neighbour_radius_log: float = Field(
        0.35,
        gt=0,
        le=5,
        description="Difference of log radii of neighbours that is usual. Larger: more clutter.",
    )
    lattice_radius_factor: float = Field(
        3.0, ge=1, le=20, description="A lattice's radii differ by so many times that. Larger: more clutter."
    )
    grow_radius_log: float = Field(
        0.8,
        gt=0,
        le=5,
        description="Most difference of the log radius from the neighbours' mean. Larger: more clutter.",
    )
    windows_nodes: tuple[_Nodes, _Nodes, _Nodes, _Nodes] = Field(
        (2, 3, 5, 7),
        description="Nodes to either side that predict a node, wider where too few are known. Larger: "
        "steadier, follows distortion less.",
    )
    min_near_nodes: int = Field(
        5,
        ge=4,
        le=100,
        description="Known nodes that predict, in the first two windows. Larger: fewer guesses.",
    )
    min_far_nodes: int = Field(
        12, ge=4, le=200, description="Known nodes that predict, in the wider windows. Larger: fewer guesses."
    )
    min_depth_share: float = Field(
        0.2,
        gt=0,
        lt=1,
        description="Least depth of a neighbour over the node's in a perspective prediction. Larger: less "
        "near the horizon.",
    )
    grow_residual_steps: float = Field(
        0.25,
        gt=0,
        lt=0.5,
        description="Most distance of a spot from its prediction. Larger: more dots, more wrong ones.",
    )
    bridge_residual_steps: float = Field(
        0.15,
        gt=0,
        lt=0.5,
        description="The same beyond a gap of hidden nodes. Larger: more dots, more wrong ones.",
    )
    bridge_nodes: int = Field(
        5,
        ge=1,
        le=20,
        description="Widest gap of hidden nodes that is bridged. Larger: slower, more guesses.",
    )
    keep_residual_steps: float = Field(
        0.12,
        gt=0,
        lt=0.5,
        description="Most distance of a spot from its prediction once all neighbours are known. Larger: "
        "keeps inconsistent nodes; smaller: distortion costs dots.",
    )
    part_gap_nodes: int = Field(
        5,
        ge=1,
        le=20,
        description="Widest gap inside one part; only the largest part is kept. Larger: keeps more.",
    )
    max_extent_factor: int = Field(
        2,
        ge=1,
        le=20,
        description="Farthest node from a seed, times the target's longer side. Larger: larger prints.",
    )
    # The grid as a whole.
    smooth_residual_steps: float = Field(
        0.25,
        gt=0,
        lt=0.5,
        description="Most distance of a spot from the smooth surface through all. Larger: bent boards "
        "pass, wrong numbers may.",
    )
    smooth_max_degree: int = Field(
        4,
        ge=1,
        le=8,
        description="Degree of that surface beside the perspective. Larger: follows more distortion.",
    )
    smooth_dots_factor: float = Field(
        2.0, ge=1, le=20, description="Dots for each of its coefficients. Larger: stiffer where dots are few."
    )
    max_lattice_shape_log: float = Field(
        0.45,
        gt=0,
        le=5,
        description="Log of the ratio of a semi-axis to the usual one from which an outline is no dot of "
        "the lattice. Larger: keeps more clutter.",
    )
    shape_px: float = Field(
        0.5,
        ge=0,
        le=10,
        description="Part of a semi-axis that pixels may change. Larger: small dots are checked less.",
    )
    # Rings, and grids without.
    ring_hole_share: float = Field(
        0.3,
        gt=0,
        lt=1,
        description="Brightness of a ring's middle, of the step from dot to board. Larger: faint rings are "
        "lost; smaller: dots with a glint count as rings.",
    )
    faint_hole_share: float = Field(
        0.1,
        gt=0,
        lt=1,
        description="Least brightness of a ring's middle in a blurred picture. Larger: fewer rings.",
    )
    full_dot_share: float = Field(
        0.15,
        gt=0,
        lt=1,
        description="Brightness of the middle below which a dot is surely full. Larger: more full dots.",
    )
    ring_outlier_sigma: float = Field(
        8.0,
        gt=0,
        le=1000,
        description="A ring's middle stands out from the other dots' by so much. Larger: fewer rings.",
    )
    pitch_ratio_log: float = Field(
        0.3,
        gt=0,
        le=5,
        description="Most error of the ratio of the pitches as seen, in its log. Larger: other targets pass.",
    )
    edge_line_share: float = Field(
        0.5,
        gt=0,
        le=1,
        description="Part of each outermost row and column that a grid without rings must show. Larger: "
        "more refusals.",
    )
    max_mark_shape_log: float = Field(
        0.15,
        gt=0,
        le=5,
        description="Log of the ratio of a semi-axis to the usual one from which a spot outside a grid "
        "without rings is a mark and no dot. Larger: letters beside a grid count as dots.",
    )
    max_dots_beyond: int = Field(
        1,
        ge=0,
        le=1000,
        description="Dots seen beyond a grid without rings that count as clutter. Larger: parts of larger "
        "prints pass.",
    )
    # Dots that segmentation missed.
    missed_rounds: int = Field(
        20, ge=0, le=1000, description="Rounds of looking, each a node farther. Larger: slower."
    )
    missed_gap_nodes: int = Field(
        4,
        ge=1,
        le=20,
        description="Nodes over which missed dots are looked for. Larger: slower, more guesses.",
    )
    missed_residual_steps: float = Field(
        0.12,
        gt=0,
        lt=0.5,
        description="Most distance of such a dot from its prediction. Larger: more wrong ones.",
    )
    missed_radius_log: float = Field(
        0.35, gt=0, le=5, description="Most error of its log radius. Larger: more wrong ones."
    )
    missed_keep_residual_steps: float = Field(
        0.2,
        gt=0,
        lt=0.5,
        description="Most distance once all neighbours are known. Larger: keeps wrong guesses at a wide "
        "lens's rim.",
    )

    @model_validator(mode="after")
    def _in_order(self) -> "GridSettings":
        if list(self.windows_nodes) != sorted(self.windows_nodes):
            raise ValueError("windows_nodes should not fall from one to the next")
        if self.faint_hole_share > self.ring_hole_share:
            raise ValueError("faint_hole_share should not be above ring_hole_share")
        return self
