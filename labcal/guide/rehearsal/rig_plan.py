"""The plan of a rig, as written in YAML: cameras, working volume, target and shoot."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from labcal.bounds import Length, Margin
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.guide.rehearsal.planned_camera import PlannedCamera
from labcal.run.names import Name, differ_in_case
from labcal.scene.camera import Coordinate, Vector
from labcal.scene.photometry import Photometry
from labcal.targets.grid import DotGrid
from labcal.targets.one_kind import described_grid

LEAST_CAMERAS = 2
FEWEST_VIEWS, MOST_VIEWS = 3, 200


class PairGeometry(BaseModel):
    """Two cameras side by side; the first one is on the left."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["pair"] = "pair"
    baseline_mm: Length
    """Distance of the centres of projection."""
    convergence_mm: Length | None = None
    """Distance, from the middle of the baseline, at which both axes meet; left out: they are parallel."""


class CameraPlace(BaseModel):
    """Place and direction of a camera."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    eye_mm: Vector
    """Centre of projection."""
    look_at_mm: Vector
    """A point that the axis meets."""
    up: Vector = (0.0, -1.0, 0.0)
    """Direction of the top of the picture."""


class ListedGeometry(BaseModel):
    """The place of every camera by its name."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["places"]
    places: dict[Name, CameraPlace]


class WorkingVolume(BaseModel):
    """The box in which points are to be measured: across and upright about the z axis, along it in depth."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    width_mm: Length
    height_mm: Length
    near_mm: Coordinate
    """Least z."""
    far_mm: Coordinate
    """Greatest z."""
    centre_mm: tuple[Coordinate, Coordinate] = (0.0, 0.0)
    """X and y of the middle."""

    @model_validator(mode="after")
    def _has_a_depth(self) -> "WorkingVolume":
        if not self.near_mm < self.far_mm:
            raise ValueError("near_mm should be less than far_mm")
        return self


class PlannedShoot(BaseModel):
    """Views of the target in the hand, and the calibration from them."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    views: Annotated[int, Field(ge=FEWEST_VIEWS, le=MOST_VIEWS)] = 12
    tilt_max_deg: Annotated[float, Field(ge=0, lt=90)] = 40.0
    """Largest angle of the target's normal to the line towards the cameras."""
    roll_max_deg: Annotated[float, Field(ge=0, le=180)] = 180.0
    """Largest turn about the normal."""
    visible_share: Annotated[float, Field(gt=0, le=1)] = 0.6
    """Share of the dots that every camera must see whole."""
    dot_places: DotTreatment = DotTreatment.AUTO
    """Treatment of the dots' places on the print by the calibration: `auto` as `labcal calibrate` decides by
    itself, `freed` (estimated, too) or `declared`."""


class RigPlan(BaseModel):
    """A rig that somebody thinks of, and what it is to measure.

    The frame of all places: the origin is the middle of the baseline (of a pair), x points right, y down and
    z forward, mm.

    Examples
    --------
    >>> from labcal import load_rig_plan
    >>> plan = load_rig_plan("webcams")
    >>> plan.volume.far_mm, list(plan.cameras)
    (850.0, ['left', 'right'])
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    description: str = ""
    cameras: Annotated[dict[Name, PlannedCamera], Field(min_length=LEAST_CAMERAS)]
    """Cameras by name; the first one is the world of the calibrated rig. In a file `camera` may describe all
    of them, which are then called `left` and `right`, or as the places are."""
    geometry: Annotated[PairGeometry | ListedGeometry, Field(discriminator="kind")]
    """Places of the cameras."""
    volume: WorkingVolume
    photometry: Photometry = Photometry()
    """The sensors; in a file the name of a preset, a preset with changes, or the whole description."""
    target: DotGrid
    """The target; in a file the name of one, or its whole description."""
    print_sigma_mm: Margin = 0.0
    """Standard deviation of each dot's place on the print along x and along y."""
    shoot: PlannedShoot = PlannedShoot()
    point_sigma_px: Annotated[float, Field(gt=0, le=100)] | None = None
    """Standard deviation of pixels of the points to be measured; that of the target's dots where left out."""

    @model_validator(mode="before")
    @classmethod
    def _camera_of_all(cls, value: object) -> object:
        if not isinstance(value, dict) or "camera" not in value:
            return value
        if "cameras" in value:
            raise ValueError("camera describes all cameras, and cameras each by its name: keep one of them")
        geometry = value.get("geometry")
        places = geometry.get("places") if isinstance(geometry, dict) else None
        names = list(places) if isinstance(places, dict) else ["left", "right"]
        rest = {key: one for key, one in value.items() if key != "camera"}
        return {**rest, "cameras": dict.fromkeys(names, value["camera"])}

    @field_validator("target", mode="before")
    @classmethod
    def _target_by_name(cls, value: object) -> object:
        return described_grid(value, "rehearsals show", "rings-14x10")

    @model_validator(mode="after")
    def _cameras_have_places(self) -> "RigPlan":
        if alike := differ_in_case(self.cameras):
            raise ValueError(f"the cameras '{alike[0]}' and '{alike[1]}' differ only in capital letters")
        if len(lenses := {camera.lens for camera in self.cameras.values()}) > 1:
            raise ValueError(
                f"a calibration has one lens model for all cameras, but {' and '.join(sorted(lenses))} are "
                "planned: choose one of them"
            )
        if isinstance(self.geometry, PairGeometry):
            if len(self.cameras) != LEAST_CAMERAS:
                raise ValueError(
                    f"a pair has two cameras, and {len(self.cameras)} are described: give the geometry of "
                    "the kind 'places' for more"
                )
        elif set(self.geometry.places) != set(self.cameras):
            raise ValueError("geometry.places should name the same cameras as cameras")
        return self
