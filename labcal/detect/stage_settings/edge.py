"""Settings of stage 3: the least-squares fit of a dot's blurred edge, and the statistics of its residuals.

Which fits are measurements, and which are `bad-fit`, is decided by stage 4: `quality.py` beside this file.
"""

from typing import ClassVar

from pydantic import Field

from labcal.detect.stage_settings.stage import StageSettings


class EdgeSettings(StageSettings):
    """Settings of the edge fit. A blur is the standard deviation of the edge; radii are those of the dot."""

    stage: ClassVar[str] = "edge"

    # Gauss-Newton.
    max_iterations: int = Field(
        12,
        ge=2,
        le=1000,
        description="Steps of Gauss-Newton. Larger: slower, a few more dots converge; smaller: more dots "
        "are bad-fit.",
    )
    shift_tolerance_px: float = Field(
        0.02, gt=0, le=1, description="The fit ends after a step so small. Larger: faster, less exact."
    )
    blur_tolerance_share: float = Field(
        0.04, gt=0, le=1, description="And after so small a change of the blur. Larger: faster, less exact."
    )
    max_step_radii: float = Field(
        0.2,
        gt=0,
        le=1,
        description="Longest step; longer ones are shortened. Larger: may run away from a poor start.",
    )
    max_blur_factor: float = Field(
        2.0,
        gt=1,
        le=10,
        description="Most change of the blur in a step. Larger: may run away from a poor start.",
    )
    max_move_radii: float = Field(
        0.5,
        gt=0,
        le=2,
        description="Most distance of the result from the start. Larger: may converge to a neighbour.",
    )
    first_blur_px: float = Field(
        0.4, gt=0, le=10, description="Least blur to begin with. Larger: for soft pictures."
    )
    max_first_blur_radii: float = Field(
        0.3, gt=0, le=1, description="Largest blur to begin with. Larger: for soft pictures of small dots."
    )
    min_blur_px: float = Field(
        0.2,
        gt=0,
        le=5,
        description="Blur of an edge that is sharper, as in a picture drawn without grey. Larger: sharp "
        "edges fit worse.",
    )
    # The pixels that are fitted.
    edge_blurs: float = Field(
        2.8,
        gt=0,
        le=6,
        description="Half width of the edge, beyond which pixels show dot or board alone. Larger: slower.",
    )
    edge_px: float = Field(0.3, ge=0, le=10, description="The same in pixels, added. Larger: slower.")
    band_blurs: float = Field(
        3.5,
        gt=0,
        le=20,
        description="Half width of the fitted band, first part. Larger: more light, more clutter.",
    )
    band_px: float = Field(
        2.0,
        ge=0,
        le=100,
        description="Second part, px or radii, whatever is more. Larger: more light, more clutter.",
    )
    band_radii: float = Field(0.12, ge=0, le=5, description="See band_px. Larger: more light, more clutter.")
    max_bands: int = Field(
        3, ge=1, le=20, description="How often a band is made anew as the blur becomes known. Larger: slower."
    )
    reband_factor: float = Field(
        1.3,
        gt=1,
        le=10,
        description="Change of the blur from which a band is made anew. Larger: faster, rougher.",
    )
    hole_blurs: float = Field(
        1.5, ge=0, le=10, description="Distance kept from a ring's hole. Larger: fewer pixels of thin rings."
    )
    clutter_sigma: float = Field(
        5.0,
        gt=0,
        le=100,
        description="Residual away from the edge that is clutter, in usual ones. Larger: dirt is kept.",
    )
    clutter_share: float = Field(
        0.08,
        gt=0,
        le=1,
        description="And at least this much of the step from dot to board. Larger: dirt is kept.",
    )
    clutter_px: float = Field(
        2.0,
        ge=0,
        le=100,
        description="Pixels so near to clutter are left out with it. Larger: leaves out more.",
    )
    # Blurred dots near each other.
    near_neighbour_blurs: float = Field(
        4.2,
        ge=0,
        le=100,
        description="Width of a dot's own surroundings below which the darkness of neighbours is subtracted. "
        "Larger: also where there is hardly any.",
    )
    neighbour_rounds: int = Field(
        2, ge=0, le=20, description="How often that is done. Larger: slower, better on dense blurred grids."
    )
    # Priors on what a small dot does not determine.
    prior_shading_share: float = Field(
        0.1,
        gt=0,
        le=100,
        description="Standard deviation expected of the shading across a dot, of its step, a radius. "
        "Larger: small dots have larger covariances.",
    )
    prior_third_harmonic_per_px: float = Field(
        1e-4,
        gt=0,
        le=1,
        description="Standard deviation expected of an outline's third harmonic, a pixel of radius. "
        "Larger: bent pictures of small dots fit better, and cost covariance.",
    )
    shared_light_share: float = Field(
        0.005,
        ge=0,
        le=1,
        description="Deviation of a dot's slope from the board's light as a prior, of its step a radius. "
        "Larger: the board's light determines dots less.",
    )
    shared_light_count: int = Field(
        2,
        ge=0,
        le=1000,
        description="Number of measurements that this prior counts for. Larger: the picture's own count "
        "less.",
    )
    # Statistics of residuals.
    sectors: int = Field(
        12,
        ge=4,
        le=360,
        description="Sectors in which the outline's departure from the ellipse is averaged. Larger: noisier.",
    )
    max_arcs: int = Field(
        24,
        ge=8,
        le=360,
        description="Arcs whose places are no noise. Larger: ragged prints widen covariances less.",
    )
    arc_px: float = Field(
        8.0, gt=1, le=1000, description="Least length of an arc. Larger: fewer arcs on small dots."
    )
    min_arcs: int = Field(
        8,
        ge=5,
        le=360,
        description="Fewer arcs are none: they are the ellipse itself. Larger: small dots have none.",
    )
    profile_bin_blurs: float = Field(
        0.5,
        ge=0.05,
        le=6,
        description="Width of a bin of the mean profile across the edge. Larger: profile is smoother.",
    )
    near_flat_blurs: float = Field(
        2.0,
        gt=0,
        le=6,
        description="Distance from the edge beyond which clutter and clipping are looked for. Larger: less.",
    )
    flat_blurs: float = Field(
        3.2,
        gt=0,
        le=6,
        description="Distance beyond which residuals are the picture's noise alone. Larger: fewer pixels.",
    )
    clipped_side_share: float = Field(
        0.01,
        ge=0,
        le=1,
        description="A side with more clipped pixels does not enter the noise. Larger: clipped sides do.",
    )
    clipped_chance_sigma: float = Field(
        2.0,
        ge=0,
        le=100,
        description="Clipped pixels on one side that chance explains. Larger: fewer saturated dots.",
    )
    clipped_value_share: float = Field(
        0.002,
        ge=0,
        lt=1,
        description="A picture is clipped where more of its pixels share the extreme value. Larger: fewer "
        "pictures are.",
    )
    noise_dots: int = Field(
        16,
        ge=1,
        le=100_000,
        description="Dots around which the correlation of noise is measured. Larger: slower, steadier.",
    )
    noise_min_pixels: int = Field(
        500,
        ge=10,
        le=10_000_000,
        description="Fewest pixels that determine it; else noise counts as white. Larger: rarer.",
    )
    noise_chance_sigma: float = Field(
        2.0,
        ge=0,
        le=100,
        description="Correlation that chance explains. Larger: covariances are widened less often.",
    )
    noise_outlines: int = Field(
        256,
        ge=1,
        le=100_000,
        description="Dots along whose outlines the noise is measured. Larger: slower, steadier.",
    )
    noise_harmonics: int = Field(
        6,
        ge=2,
        le=100,
        description="Most harmonics of an outline by which it is. Larger: slower, steadier.",
    )
    noise_short_px: float = Field(
        4.5,
        gt=2,
        le=100,
        description="Shortest wave along an outline that tells of its noise. Larger: fewer harmonics.",
    )
    noise_long_px: float = Field(
        24.0,
        gt=4,
        le=10_000,
        description="Longest one: longer waves are the print's. Larger: ragged prints widen covariances.",
    )
    noise_smoothing_px: float = Field(
        0.9,
        ge=0,
        le=100,
        description="Standard deviation of the most that demosaicing or compression smooths noise. Larger: "
        "ragged prints widen covariances.",
    )
    noise_outlier_factor: float = Field(
        5.0,
        gt=1,
        le=1000,
        description="Noise over the usual one from which a dot does not count. Larger: bad fits do.",
    )
    stepped_variance_px3: float = Field(
        0.009,
        ge=0,
        le=10,
        description="Variance times radius of the centre of an outline that runs in steps from pixel to "
        "pixel. Larger: larger covariances in pictures drawn without grey.",
    )
