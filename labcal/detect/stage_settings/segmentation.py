"""Settings of stage 1: the search for dark spots, and the tracing of their ellipses."""

from typing import ClassVar

from pydantic import Field, model_validator

from labcal.detect.stage_settings.stage import StageSettings


class SegmentationSettings(StageSettings):
    """Settings of segmentation. Pixels "of a level" are those of the picture halved some times."""

    stage: ClassVar[str] = "segmentation"

    # Dark spots, level by level.
    coarse_side_px: int = Field(
        700,
        ge=32,
        le=100_000,
        description="Longer side of the level where the search begins. Larger: slower, fewer second looks.",
    )
    smallest_level_px: int = Field(
        12, ge=4, le=1000, description="Shorter side of the coarsest level. Larger: huge dots are missed."
    )
    max_spot_axis_px: float = Field(
        12.0,
        gt=1,
        le=1000,
        description="Semi-axis, in pixels of the first level, above which coarser levels are searched as "
        "well. Larger: large dots are looked for in fewer levels.",
    )
    min_resolved_axis_px: float = Field(
        3.5,
        gt=0,
        le=100,
        description="Semi-axis, in pixels of a level, below which a finer level is searched as well. "
        "Larger: slower, small dots are missed less often.",
    )
    smoothing_px: float = Field(
        0.8,
        ge=0.1,
        le=3,
        description="Standard deviation of the 3 x 3 Gaussian before thresholding. Larger: less noise, "
        "small dots fade.",
    )
    threshold_reach_px: int = Field(
        9,
        ge=2,
        le=200,
        description="Half the window, of a level, whose extremes set the threshold. Larger: follows the "
        "light less closely, finds larger dots in one level.",
    )
    min_contrast_sigma: float = Field(
        8.0,
        ge=0,
        le=1000,
        description="Least range of grey values in a window, in standard deviations of the noise. Larger: "
        "fewer false spots, faint dots are lost.",
    )
    min_contrast_share: float = Field(
        0.05,
        ge=0,
        lt=1,
        description="Least range of grey values in a window, of the picture's range. Larger: fewer false "
        "spots, dots in shade are lost.",
    )
    range_cut_percent: float = Field(
        0.5,
        ge=0,
        lt=50,
        description="Pixels left out at either end of the picture's range. Larger: reflections matter less.",
    )
    max_texture_share: float = Field(
        0.15,
        gt=0,
        le=1,
        description="Most changes between dark and bright a pixel along a row, around a spot. Larger: "
        "spots in texture and noise are kept.",
    )
    texture_reach_px: int = Field(
        15, ge=2, le=500, description="Half the window in which these changes are counted. Larger: smoother."
    )
    min_contour_points: int = Field(
        6, ge=5, le=1000, description="Fewest pixels of a contour. Larger: the smallest spots are lost."
    )
    min_spot_axis_px: float = Field(
        1.2,
        gt=0,
        le=100,
        description="Least minor semi-axis of a spot, of a level. Larger: fewer false spots, small dots "
        "are lost.",
    )
    min_axis_ratio_share: float = Field(
        0.2,
        gt=0,
        lt=1,
        description="Least minor over major semi-axis (0.2: a disc seen at 78 degrees). Larger: dots of a "
        "board at a grazing angle are lost.",
    )
    max_axis_share: float = Field(
        0.2,
        gt=0,
        le=1,
        description="Largest semi-axis, of the picture's longer side. Larger: shadows may pass.",
    )
    max_contour_scatter_share: float = Field(
        0.1,
        ge=0,
        le=1,
        description="Most scatter of a contour about its ellipse, of the radius. Larger: more ragged spots "
        "pass.",
    )
    max_contour_scatter_px: float = Field(
        0.35, ge=0, le=10, description="The same in pixels of a level, added. Larger: more ragged spots pass."
    )
    # Ellipses traced along rays; radii are those of the spot.
    duplicate_spot_radii: float = Field(
        0.1,
        gt=0,
        lt=1,
        description="Spots nearer than this, and as similar in size, are one. Larger: faster, neighbours "
        "may merge.",
    )
    duplicate_outline_radii: float = Field(
        0.4,
        gt=0,
        lt=1,
        description="Traced outlines nearer than this, and as similar in size, are one. Larger: neighbours "
        "may merge.",
    )
    ray_count: int = Field(
        24,
        ge=8,
        le=360,
        description="Rays cast from the middle of a spot. Larger: slower, steadier outlines.",
    )
    ray_length_radii: float = Field(
        1.5,
        gt=1.05,
        le=5,
        description="Length of a ray, less where neighbours are near. Larger: rough sizes may be further "
        "off.",
    )
    ray_step_px: float = Field(
        1.0, gt=0.05, le=10, description="Distance of samples along a ray. Larger: faster, rougher."
    )
    min_ray_samples: int = Field(20, ge=8, le=1000, description="Fewest samples of a ray. Larger: slower.")
    max_ray_samples: int = Field(
        64, ge=8, le=10_000, description="Most samples of a ray. Larger: slower, finer in large dots."
    )
    edge_search_radii: float = Field(
        0.5,
        ge=0.05,
        lt=1,
        description="Where along a ray the search for the edge begins. Larger: holes of rings disturb "
        "less, rough sizes must be better.",
    )
    dot_level_from_radii: float = Field(
        0.6,
        ge=0.05,
        lt=1,
        description="Where the part that shows the dot's own grey value begins. Larger: larger holes.",
    )
    dot_level_to_radii: float = Field(
        0.75,
        ge=0.05,
        lt=1,
        description="Where it ends. Larger: more pixels, with more of the edge among them.",
    )
    board_level_share: float = Field(
        0.6,
        ge=0,
        lt=1,
        description="From where on, of the way from the edge to the ray's end, a ray shows the board. "
        "Larger: soft edges matter less, neighbours more.",
    )
    clear_gap_share: float = Field(
        0.7,
        gt=0,
        lt=1,
        description="Part of the gap between two dots that belongs to one of them. Larger: wider bands, "
        "which neighbours may reach into.",
    )
    min_ray_share: float = Field(
        0.75,
        gt=0.25,
        le=1,
        description="Least share of rays whose edge fits the ellipse. Larger: dots that are hidden in part "
        "are lost.",
    )
    ellipse_rounds: int = Field(
        3, ge=1, le=100, description="Fits of the ellipse, outliers left out after each. Larger: slower."
    )
    outlier_factor: float = Field(
        4.0,
        ge=1,
        le=100,
        description="Edge points so many median residuals off are left out. Larger: keeps more.",
    )
    outlier_share: float = Field(
        0.02, ge=0, lt=1, description="Least such limit, of the squared radius. Larger: keeps more."
    )
    max_roughness_share: float = Field(
        0.03,
        ge=0,
        lt=1,
        description="Most median distance of edge points from the ellipse, of the radius. Larger: more "
        "ragged dots, more false ones.",
    )
    max_roughness_px: float = Field(
        0.15, ge=0, le=10, description="The same in pixels, added. Larger: more false dots."
    )
    max_offset_radii: float = Field(
        0.5,
        gt=0,
        le=1,
        description="Most that the ellipse's centre is off the spot's. Larger: may leave the spot.",
    )
    min_outline_axis_px: float = Field(
        1.5, gt=0, le=100, description="Least minor semi-axis of an outline. Larger: small dots are lost."
    )
    retrace_radii: float = Field(
        0.05,
        ge=0,
        lt=1,
        description="An outline that moved further is traced again. Larger: faster, rougher.",
    )

    @model_validator(mode="after")
    def _in_order(self) -> "SegmentationSettings":
        if self.min_ray_samples > self.max_ray_samples:
            raise ValueError("min_ray_samples should not be above max_ray_samples")
        if self.dot_level_from_radii >= self.dot_level_to_radii:
            raise ValueError("dot_level_from_radii should be below dot_level_to_radii")
        return self
