"""Settings of the detection of ChArUco boards: markers, and the fit of corners."""

from typing import ClassVar

from pydantic import Field

from labcal.detect.stage_settings.stage import StageSettings


class CornerSettings(StageSettings):
    """Settings of corners. A square is one of the board's in the picture, a blur the deviation of an edge."""

    stage: ClassVar[str] = "corner"

    min_picture_px: int = Field(
        32,
        ge=8,
        le=10_000,
        description="Shorter side of a picture that may show a board. Larger: more refusals.",
    )
    min_marker_px: float = Field(
        12.0,
        ge=4,
        le=1000,
        description="Side of the smallest marker looked for. Larger: faster, small markers are lost.",
    )
    other_board_markers: int = Field(
        6,
        ge=2,
        le=1000,
        description="Number of markers that do not agree with the board that prove another one. Larger: "
        "'other-board' is rarer.",
    )
    code_false_alarm_share: float = Field(
        1e-7,
        gt=0,
        le=0.01,
        description="Probability that chance places a board by codes that are not read one by one. Larger: "
        "more worn and blurred boards are placed, and wrong ones.",
    )
    min_code_sigma: float = Field(
        3.0,
        ge=1,
        le=100,
        description="Deviations by which codes must speak for a place without the clearest one, and against "
        "any other place. Larger: more refusals.",
    )
    max_code_contradiction_share: float = Field(
        0.15,
        gt=0,
        le=1,
        description="Most share of the codes, by how clear they are, that are unlike those of the board. "
        "Larger: more dirty boards are placed, and boards with other squares.",
    )
    min_code_squares: int = Field(
        2,
        ge=2,
        le=1000,
        description="Fewest whole squares with codes that place a board. Larger: more refusals.",
    )
    max_marker_residual_squares: float = Field(
        0.25,
        gt=0,
        lt=0.5,
        description="Most distance of a marker's corners from where its neighbours predict them. Larger: "
        "more markers count on a bent board, and wrong ones.",
    )
    range_cut_percent: float = Field(
        0.1,
        ge=0,
        lt=50,
        description="Pixels left out at either end of the range. Larger: reflections matter less.",
    )
    max_iterations: int = Field(
        30, ge=2, le=1000, description="Steps of Gauss-Newton. Larger: slower, a few more corners converge."
    )
    first_tolerance_px: float = Field(
        0.05, gt=0, le=1, description="Step at which the first round ends. Larger: faster, rougher windows."
    )
    tolerance_px: float = Field(
        5e-4, gt=0, le=1, description="Step at which the fit ends. Larger: faster, less exact."
    )
    max_step_px: float = Field(
        1.0, ge=0.001, le=100, description="Longest step; longer ones are shortened. Larger: may run away."
    )
    max_turn_rad: float = Field(
        0.3, ge=0.001, le=3, description="Most turn of an edge in a step. Larger: may run away."
    )
    first_blur_px: float = Field(
        0.8, ge=0.05, le=20, description="Blur to begin with. Larger: for soft pictures."
    )
    min_blur_px: float = Field(0.3, ge=0.01, le=5, description="Least blur. Larger: sharp edges fit worse.")
    max_blur_squares: float = Field(
        0.25, gt=0, le=1, description="Blur above which a corner is bad-fit. Larger: soft corners are kept."
    )
    max_move_squares: float = Field(
        0.2,
        gt=0,
        lt=0.5,
        description="Most distance of the result from the start. Larger: may converge to another.",
    )
    reach_bend_px: float = Field(
        0.08,
        gt=0,
        le=10,
        description="Squared reach of a fit over the picture's width: 0.08 px let a wide lens bend an edge "
        "by 0.01 px. Larger: more pixels, more bias of wide lenses.",
    )
    min_reach_px: float = Field(
        5.0, ge=3, le=1000, description="Least reach of a fit. Larger: more pixels, more bias."
    )
    max_reach_squares: float = Field(
        0.45,
        gt=0,
        lt=0.5,
        description="Most reach, before the next corner. Larger: more pixels, more of the next edges.",
    )
    max_reach_px: float = Field(
        60.0,
        ge=5,
        le=1000,
        description="Most reach once the bend of the edges is known. Larger: slower, more exact.",
    )
    wide_reach_squares: float = Field(
        0.5,
        gt=0,
        le=0.6,
        description="Reach of the wider fit, to the next corner's. Larger: more of the next edges.",
    )
    edge_blurs: float = Field(
        4.5,
        ge=4,
        le=100,
        description="Distance from the edges of the wider fit's pixels, at most. Larger: slower.",
    )
    clear_roughness_factor: float = Field(
        1.4,
        ge=1.1,
        le=100,
        description="Roughness, in that of the corners around, above which a corner is bad-fit. Larger: "
        "fewer are.",
    )
    max_refit_blurs: float = Field(
        0.5,
        gt=0,
        le=5,
        description="Most distance of the wider fit from the first one. Larger: more beside obstacles pass.",
    )
    marker_guard_blurs: float = Field(
        1.0,
        ge=0,
        le=10,
        description="Distance kept from markers. Larger: fewer pixels, less of the markers' borders.",
    )
    frame_margin_px: float = Field(
        3.0, ge=1, le=1000, description="A corner nearer to the frame is cut. Larger: more corners are."
    )
    min_pixels: int = Field(
        40, ge=20, le=100_000, description="Fewest pixels of a fit. Larger: more corners are bad-fit."
    )
    flat_blurs: float = Field(
        2.5,
        gt=0,
        le=10,
        description="Distance from both edges beyond which residuals are noise. Larger: fewer pixels.",
    )
    tone_levels: int = Field(
        6,
        ge=1,
        le=100,
        description="Grey levels to either side at which a tone curve is distinguished from noise. Larger: "
        "finer.",
    )
    min_variance_share: float = Field(
        0.1,
        gt=0,
        le=1,
        description="Least variance of noise at a level, of the mean. Larger: evener weights.",
    )
    roughness_factor: float = Field(
        2.5,
        ge=1,
        le=100,
        description="Roughness, in usual ones, above which a corner is bad-fit. Larger: fewer are.",
    )
    roughness_share: float = Field(
        0.06, ge=0, le=1, description="The same of the step, added. Larger: fewer are bad-fit."
    )
    min_step_share: float = Field(
        0.3,
        ge=0,
        lt=1,
        description="Least step from black to white, of the usual one. Larger: faint corners are bad-fit.",
    )
    max_residual_squares: float = Field(
        0.1,
        gt=0,
        lt=0.5,
        description="Most distance of a corner without markers from its prediction. Larger: more wrong ones.",
    )
    max_error_blurs: float = Field(
        0.25,
        gt=0,
        le=5,
        description="Error that its pixels leave of a corner above which it is bad-fit; blurs are those of a "
        "pixel and the lens together. Larger: more corners of which little is seen are kept.",
    )
    max_error_factor: float = Field(
        10.0,
        ge=2,
        le=1000,
        description="The same in the usual error of the picture's corners. Larger: fewer are bad-fit.",
    )
    clipped_value_share: float = Field(
        0.002,
        ge=0,
        lt=1,
        description="A picture is clipped where more of its pixels share the largest value. Larger: fewer "
        "are.",
    )
