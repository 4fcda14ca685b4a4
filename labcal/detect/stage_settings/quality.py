"""Settings of stage 4: flags of dots and refusals of pictures."""

from typing import ClassVar

from pydantic import Field

from labcal.detect.stage_settings.stage import StageSettings


class QualitySettings(StageSettings):
    """Settings of flags and refusals. Larger limits keep more dots and pictures, and more doubtful ones."""

    stage: ClassVar[str] = "quality"

    # Measured dots.
    max_blur_share: float = Field(
        0.5,
        gt=0,
        le=2,
        description="Blur over the dot's mean radius above which it is blurred. Larger: fewer are.",
    )
    max_clipped_share: float = Field(
        0.06,
        ge=0,
        le=1,
        description="One-sided clipping beside the edge above which a dot is saturated. Larger: fewer are.",
    )
    departure_factor: float = Field(
        2.5,
        ge=1,
        le=100,
        description="Departure from the ellipse, in usual ones, above which a dot is bad-fit. Larger: "
        "fewer are.",
    )
    departure_share: float = Field(
        0.001, ge=0, le=1, description="The same of the radius, added. Larger: fewer are."
    )
    max_misfit_factor: float = Field(
        1.5,
        gt=1,
        le=100,
        description="Standard deviation of the residuals, over the usual one in such light, above which a "
        "dot is bad-fit. Larger: fewer are.",
    )
    max_ring_misfit_factor: float = Field(
        2.0,
        gt=1,
        le=100,
        description="The same of rings, whose holes shine into the fit. Larger: fewer are bad-fit.",
    )
    max_paleness_share: float = Field(
        0.2,
        gt=0,
        le=10,
        description="Brightness of a dot above the usual one in such light, of the step, above which it is "
        "bad-fit. Larger: fewer are.",
    )
    max_shape_log: float = Field(
        0.2,
        gt=0,
        le=5,
        description="Log of the ratio of a semi-axis to the one that the grid predicts, within the grid, "
        "above which a dot is bad-fit. Larger: fewer are.",
    )
    max_rim_shape_log: float = Field(
        0.3,
        gt=0,
        le=5,
        description="The same at the grid's rim, where steps are less sure. Larger: fewer are bad-fit.",
    )
    interior_neighbours: int = Field(
        12,
        ge=1,
        le=24,
        description="Neighbours within two nodes of a dot that is within the grid. Larger: more are at its "
        "rim.",
    )
    # What is usual in a picture's light.
    trend_min_dots: int = Field(
        8,
        ge=4,
        le=1000,
        description="Fewer dots determine no trend with the light. Larger: a median is taken more often.",
    )
    trend_min_span_share: float = Field(
        0.05,
        ge=0,
        lt=1,
        description="Light must differ by so much to determine a trend. Larger: a median is taken more "
        "often.",
    )
    min_noise_share: float = Field(
        0.01,
        ge=0,
        le=1,
        description="Residuals so small, of the step, are always usual. Larger: fewer dots are bad-fit.",
    )
    min_variance_share: float = Field(
        0.6,
        ge=0,
        le=1,
        description="Usual variance is at least so much of the median dot's. Larger: fewer are bad-fit.",
    )
    # Dots that are not measured.
    cut_margin_px: float = Field(
        1.0,
        ge=0,
        le=100,
        description="An outline expected so near to the frame may be cut. Larger: more dots are cut.",
    )
    cut_residual_radii: float = Field(
        0.35,
        gt=0,
        le=2,
        description="Most error of a cut spot's box against the one expected. Larger: more are cut.",
    )
    unclean_residual_radii: float = Field(
        0.5,
        gt=0,
        le=2,
        description="Most distance of an unclean spot from its node. Larger: more bad-fit, fewer hidden.",
    )
    unclean_radius_log: float = Field(
        0.5, gt=0, le=5, description="Most error of its log radius. Larger: more bad-fit, fewer hidden dots."
    )
    unclean_neighbours: int = Field(
        5,
        ge=1,
        le=24,
        description="Neighbours that predict a dot without a clean outline. Larger: fewer are reported.",
    )
    hidden_neighbours: int = Field(
        8,
        ge=1,
        le=24,
        description="Neighbours that predict a hidden dot. Larger: fewer hidden dots are reported.",
    )
    no_id_radius_log: float = Field(
        0.5,
        gt=0,
        le=5,
        description="Spots of about a dot's size are reported as no-id. Larger: more clutter is reported.",
    )
    no_id_distance_radii: float = Field(
        0.5, gt=0, le=5, description="Distance of such spots from every dot. Larger: fewer are reported."
    )
    # Pictures.
    min_usable_share: float = Field(
        0.1,
        ge=0,
        lt=1,
        description="Part of the whole dots that must be measured, or the picture is refused "
        "(no-usable-dots). Larger: more refusals.",
    )
    max_clipped_picture_share: float = Field(
        0.5,
        gt=0,
        le=1,
        description="Clipped part of a picture without a grid above which the refusal is saturated. "
        "Larger: rarer.",
    )
    soft_share: float = Field(
        0.2,
        gt=0,
        le=2,
        description="Median blur over minor semi-axis above which the refusal of a picture without a grid "
        "is blurred. Larger: rarer.",
    )
    soft_px: float = Field(
        1.5, ge=0, le=100, description="And the median blur must be above this. Larger: rarer."
    )
    burnt_share: float = Field(
        0.8,
        gt=0,
        le=1,
        description="Median clipped part of the bright side above which, with burnt_profile_share, all "
        "dots are saturated. Larger: rarer.",
    )
    burnt_profile_share: float = Field(
        0.028,
        gt=0,
        le=1,
        description="Median departure of the edge's profile from an error function, of the step. Larger: "
        "rarer.",
    )
