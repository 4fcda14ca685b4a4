"""Settings of the search for the corners of plain chessboards, before they are fitted."""

from typing import ClassVar

from pydantic import Field

from labcal.detect.stage_settings.stage import StageSettings


class SaddleSettings(StageSettings):
    """Settings of saddle points. Lengths are pixels of the picture as it is searched, reduced or not."""

    stage: ClassVar[str] = "saddle"

    first_side_px: int = Field(
        700,
        ge=64,
        le=100_000,
        description="Longer side of the picture that is searched first; then of twice that, up to the whole. "
        "Larger: slower, finer squares at once.",
    )
    blur_px: float = Field(
        1.2,
        ge=0.3,
        le=10,
        description="Blur before curvatures are taken. Larger: bears noise, loses small squares.",
    )
    ring_px: float = Field(
        4.0,
        ge=2,
        le=50,
        description="Radius of the ring around a saddle point that is read. Larger: squares must be.",
    )
    noise_factor: float = Field(
        6.0,
        gt=0,
        le=1000,
        description="Least curvature, in the picture's usual one. Larger: faint boards are lost.",
    )
    max_saddles: int = Field(
        4000,
        ge=9,
        le=1_000_000,
        description="Saddle points looked at, the strongest first. Larger: slower in clutter.",
    )
    max_odd_share: float = Field(
        0.35,
        gt=0,
        lt=1,
        description="Most of a ring's variance that differs on opposite sides. Larger: more clutter.",
    )
    max_uneven_share: float = Field(
        0.5,
        gt=0,
        lt=1,
        description="Most of a ring's variance that two crossing edges do not explain. Larger: more clutter.",
    )
    min_angle_deg: float = Field(
        12.0, gt=0, lt=90, description="Least angle between the edges. Larger: steep boards are lost."
    )
    max_bend_deg: float = Field(
        16.0,
        gt=0,
        lt=45,
        description="Most angle from an edge to the next corner on it. Larger: more wrong seeds.",
    )
    max_step_factor: float = Field(
        2.0,
        gt=1,
        le=10,
        description="Most ratio of neighbouring steps along an edge, and of their contrasts. Larger: steeper "
        "perspective, more clutter.",
    )
    min_step_share: float = Field(
        0.1,
        gt=0,
        lt=1,
        description="Least contrast of a corner, of that where the board is found first. Larger: less "
        "clutter, corners in shadow are lost.",
    )
    max_seeds: int = Field(60, ge=1, le=1_000_000, description="Seeds tried. Larger: slower in clutter.")
    max_lattices: int = Field(6, ge=1, le=1000, description="Lattices grown. Larger: slower in clutter.")
    min_corners: int = Field(
        9, ge=4, le=1000, description="Fewest corners of a board. Larger: small parts are refused."
    )
    min_line_share: float = Field(
        0.6,
        gt=0.5,
        le=1,
        description="Part of each outermost line of corners that a board without marks must show, unless "
        "enough neighbours of it are seen. Larger: more refusals.",
    )
    min_line_run: int = Field(
        3,
        ge=3,
        le=1000,
        description="Neighbouring corners of an outermost line that show it as well. Larger: more refusals.",
    )
    min_mark_share: float = Field(
        0.4,
        gt=0,
        lt=1,
        description="Least contrast of a mark, of that of black and white. Larger: faint marks are lost.",
    )
    max_plain_share: float = Field(
        0.2,
        gt=0,
        lt=1,
        description="Most contrast of a square without a mark. Larger: shadows pass for plain.",
    )
    min_marks: int = Field(
        2, ge=2, le=20, description="Fewest marks that number a part of a board. Larger: more refusals."
    )
