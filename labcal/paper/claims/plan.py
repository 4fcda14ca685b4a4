"""The plan of the tests of the claims, written down before their first run."""

import hashlib
from enum import StrEnum
from functools import lru_cache
from importlib.resources import files
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.paper.claims.statement import Statement
from labcal.run.descriptions import parse_yaml, validate_description

ORACLE = "oracle"
"""A method beside labcal's own: the exact cameras, with the plane known where points lie on one."""
_FILE = "claims.yaml"
Factor = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class ArmData(StrEnum):
    """The source of the points of an arm."""

    PLANE = "plane"
    VOLUME = "volume"
    FOCAL_LENGTHS = "focal-lengths"
    POSITIONS = "positions"
    DISTORTED_VOLUME = "distorted-volume"
    WEBCAM_PICTURES = "webcam-pictures"
    STILL_PICTURES = "still-pictures"


class ArmNoise(StrEnum):
    """The Gaussian error of image coordinates."""

    NONE = "none"
    SPREAD = "spread"
    PIXEL = "pixel"


class Arm(BaseModel):
    """One way to get 3-D points: data, noise and a method."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    data: ArmData
    points: int = Field(ge=4)
    """Training points."""
    placed: Literal["grid", "random"] = "grid"
    """Places of the training points on simulated planes; points of a volume are random."""
    noise: ArmNoise = ArmNoise.NONE
    k1: float = 0.0
    """Radial distortion of both cameras, of `distorted-volume` only."""
    tested: Literal["trained", "between"] = "trained"
    """Focal lengths or positions of the test points: those that were trained, or half-way between them."""
    method: str = "mlp"
    """A method of labcal, or `oracle`."""
    hidden: tuple[int, ...] = (20, 30)
    goal: float | None = Field(None, gt=0.0)
    max_epochs: int = 1000


class Comparison(BaseModel):
    """A statement about the ratio of a figure of one arm to that of another, or to a value."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    where: str
    of: str
    """Name of the arm."""
    over: str | Factor
    """Name of the other arm, or a value in the unit of the figure."""
    figure: Literal["rmse_mm", "further_rmse", "epochs"] = "rmse_mm"
    at_most: Factor | None = None
    more_than: Factor | None = None
    equivalent: Annotated[float, Field(gt=1.0, allow_inf_nan=False)] | None = None
    seeds: int | None = Field(None, ge=1)
    """Number of pairs; that of the claim where not given."""

    @model_validator(mode="after")
    def _one_statement(self) -> "Comparison":
        stated = [kind for kind in Statement if getattr(self, kind.field) is not None]
        if len(stated) != 1:
            raise ValueError("a comparison states one of at_most, more_than and equivalent")
        return self

    @property
    def statement(self) -> Statement:
        """The kind of statement."""
        return next(kind for kind in Statement if getattr(self, kind.field) is not None)

    @property
    def factor(self) -> float:
        """The ratio of the statement."""
        return float(getattr(self, self.statement.field))


class Claim(BaseModel):
    """A claim of the paper as a hypothesis."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    claim: str
    """In the paper's sense, in our words."""
    expected: str
    """Our expectation before the first run."""
    seeds: int = Field(ge=1)
    arms: dict[str, Arm]
    comparisons: tuple[Comparison, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _known_arms(self) -> "Claim":
        for one in self.comparisons:
            for arm in (one.of, one.over):
                if isinstance(arm, str) and arm not in self.arms:
                    raise ValueError(f"there is no arm '{arm}'; there are {', '.join(self.arms)}")
        unused = set(self.arms) - {name for one in self.comparisons for name in (one.of, one.over)}
        if unused:
            raise ValueError(f"no comparison uses the arms {', '.join(sorted(unused))}")
        return self

    def pairs(self, comparison: Comparison, most: int | None) -> int:
        """Return the number of seeds of a comparison, at most `most`."""
        planned = comparison.seeds or self.seeds
        return planned if most is None else min(planned, most)

    def compared_arms(self, comparison: Comparison) -> tuple[str, ...]:
        """Return the names of the one or two arms of a comparison."""
        return tuple(name for name in (comparison.of, comparison.over) if isinstance(name, str))


class Amendment(BaseModel):
    """A change of the plan after its first run."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    claim: str
    change: str
    reason: str


class Plan(BaseModel):
    """All claims by name."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal[1]
    amended: tuple[Amendment, ...]
    claims: dict[str, Claim]


@lru_cache(maxsize=1)
def claims_plan() -> Plan:
    """Return the plan that ships with labcal."""
    return validate_description(Plan, "plan", _FILE, parse_yaml(_text(), _FILE))


def plan_digest() -> str:
    """Return the SHA-256 of the plan's file, as result files name it."""
    return hashlib.sha256(_text().encode()).hexdigest()


def _text() -> str:
    return (files("labcal.paper.claims") / _FILE).read_text(encoding="utf-8")
