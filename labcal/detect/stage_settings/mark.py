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
    max_gap_share: float = Field(
        0.4,
        gt=0,
        lt=1,
        description="Grey value up to which paper between a dot and its ring counts as white. Larger: softer "
        "marks are looked at, more clutter, too.",
    )
    blur_variance_share: float = Field(
        0.03,
        ge=1e-6,
        le=10,
        description="Variance of sectors' grey values, over that of the print's, when blur is undone. "
        "Larger: less noise, more blur.",
    )
    candidate_words: int = Field(
        96,
        ge=2,
        le=10000,
        description="Words of the code, with their starts, that are compared with what is seen. Larger: "
        "slower.",
    )
    least_sigma_share: float = Field(
        0.04,
        ge=0.001,
        le=0.3,
        description="Least standard deviation of grey values: light, print and blur are uneven. Larger: "
        "marks of uneven prints are read, clutter may be.",
    )
    max_sigma_share: float = Field(
        0.25,
        gt=0.01,
        le=1,
        description="The greatest that is believed. Larger: noisier marks are read, clutter may be.",
    )
    sample_weight_share: float = Field(
        0.5,
        ge=0.01,
        le=1,
        description="Weight of one of the eight samples of a sector, since neighbours err alike. Larger: the "
        "best word seems more certain.",
    )
    cover_end_log: float = Field(
        6.0,
        ge=0,
        le=100,
        description="Cost of either end of an arc of the ring that is hidden, as a log-likelihood. Larger: "
        "fewer covers are seen.",
    )
    max_hidden_share: float = Field(
        0.45,
        ge=0,
        le=0.6,
        description="Most of a ring that may be hidden, blurred ends of covers, too. Larger: more marks are "
        "read, by fewer sectors.",
    )
    min_margin_log: float = Field(
        40.0,
        ge=1,
        le=1000,
        description="Least likelihood of the best word over that of the best of any other mark. Larger: "
        "fewer marks are read, wrong ones are rarer.",
    )
    min_evidence_log: float = Field(
        1.0,
        ge=0,
        le=10,
        description="The same over that of a ring of which nothing is in sight, a sample. Larger: fewer "
        "marks are read, clutter is taken for one more rarely.",
    )
    min_sight_log: float = Field(
        0.8,
        ge=0,
        le=10,
        description="The same of a spot that is reported as a mark without a name. Larger: less clutter is "
        "reported.",
    )
    min_gap_share: float = Field(
        0.75,
        ge=0,
        le=1,
        description="Least share of white paper between a dot and its ring, by which a spot is taken for a "
        "mark at all. Larger: less clutter is looked at.",
    )
    min_colour_share: float = Field(
        0.1,
        ge=0,
        lt=0.5,
        description="Least share of the ring that is black and in sight, and white and in sight, likewise. "
        "Larger: the same.",
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
