"""Settings of the search for marks: the rings of coded dots, and the corners of tags."""

from typing import ClassVar

from pydantic import Field

from labcal.detect.stage_settings.stage import StageSettings


class MarkSettings(StageSettings):
    """Settings of marks. Grey values are shares of the step from paper (0) to dot (1)."""

    stage: ClassVar[str] = "mark"

    max_texture_share: float = Field(
        0.4,
        gt=0,
        le=1,
        description="Most changes between dark and bright a pixel along a row, around a dot; rings have "
        "many. Larger: dots in texture and noise are looked at, too.",
    )
    hidden_level_share: float = Field(
        0.4,
        gt=0,
        lt=1,
        description="Grey value of paper beside the ring from which on something hides it there, in soft "
        "pictures. Larger: softer ones are read, what hides it is missed.",
    )
    least_hidden_share: float = Field(
        0.08,
        ge=0,
        lt=1,
        description="The same in sharp pictures. Larger: faint shadows are missed, bright covers, too.",
    )
    cover_likeness_share: float = Field(
        0.35,
        gt=0,
        le=2,
        description="The ring is hidden where its grey value is so near to that of what hides paper beside "
        "it. Larger: more sectors are left out.",
    )
    ring_overshoot_share: float = Field(
        0.45,
        gt=0,
        le=10,
        description="A sector so much darker than the dot, or brighter than paper, is hidden. Larger: fewer "
        "are.",
    )
    blur_variance_share: float = Field(
        0.03,
        ge=1e-6,
        le=10,
        description="Variance of sectors' grey values, over that of the print's, when blur is undone. "
        "Larger: less noise, more blur.",
    )
    max_hidden_share: float = Field(
        0.34,
        ge=0,
        le=0.6,
        description="Most of a ring that may be hidden. Larger: more marks are read, by fewer sectors.",
    )
    min_gap_share: float = Field(
        0.75,
        ge=0,
        le=1,
        description="Least share of white paper between a dot and its ring, by which a spot is taken for a "
        "mark at all. Larger: less clutter is reported as marks without a name.",
    )
    min_sight_share: float = Field(
        0.5,
        ge=0,
        le=1,
        description="Least share of sectors in sight, likewise. Larger: less clutter is reported.",
    )
    max_residual_share: float = Field(
        0.25,
        gt=0,
        le=1,
        description="Most root mean square departure of sectors from the code, blurred as the dot is. "
        "Larger: noisier marks are read, clutter may be.",
    )
    max_wrong_sectors: int = Field(
        1,
        ge=0,
        le=3,
        description="Most sectors of the other colour than the code has. Larger: more marks are read, wrong "
        "ones too.",
    )
    min_margin_sectors: float = Field(
        1.6,
        ge=0.1,
        le=7,
        description="By so many sectors, and half as many for each of the wrong colour, the best word fits "
        "better than any of another mark. Larger: fewer marks are read, wrong ones are rarer.",
    )
    min_colour_share: float = Field(
        0.2,
        ge=0,
        lt=0.5,
        description="Least share of black sectors, and of white ones, in sight. Larger: the same.",
    )
    max_perspective_radii: float = Field(
        0.12,
        ge=0,
        lt=0.3,
        description="Largest displacement of a circle's centre by perspective, in radii of the dot, that is "
        "tried. Larger: slower, large dots at close range are read.",
    )
    perspective_per_px: float = Field(
        0.004,
        ge=0,
        lt=1,
        description="The same a px of the dot's radius, which bounds it for small dots. Larger: slower, "
        "wider lenses are read at closer range.",
    )
    perspective_step_radii: float = Field(
        0.03, ge=0.005, le=0.3, description="Steps in which it is tried. Larger: faster, rougher."
    )
    usual_departure_factor: float = Field(
        3.0,
        ge=1,
        le=100,
        description="Departures of outlines from ellipses that are usual in a picture count up to so many "
        "times those that noise explains. Larger: more ragged prints are measured.",
    )
