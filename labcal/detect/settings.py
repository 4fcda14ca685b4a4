"""All settings of detection in one object, and their names for the command line and the documentation."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from annotated_types import Ge, Gt, Le, Lt
from pydantic import ValidationError
from pydantic.fields import FieldInfo

from labcal.arguments import texts
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.detect.stage_settings.edge import EdgeSettings
from labcal.detect.stage_settings.grid import GridSettings
from labcal.detect.stage_settings.quality import QualitySettings
from labcal.detect.stage_settings.segmentation import SegmentationSettings
from labcal.detect.stage_settings.stage import StageSettings
from labcal.errors import InputError, UnknownNameError
from labcal.wording import clipped

UNITS = {
    "px": "px",
    "px3": "px cubed",
    "per_px": "1/px",
    "deg": "degrees",
    "rad": "radians",
    "share": "of 1",
    "percent": "%",
    "factor": "times",
    "sigma": "standard deviations",
    "log": "natural logarithm of a ratio",
    "blurs": "blurs of the edge",
    "radii": "radii of the dot",
    "steps": "grid steps",
    "nodes": "grid nodes",
    "squares": "squares of the board",
}
"""Unit of a setting by the end of its name; a whole number whose name ends otherwise is a count."""
_PREFIX = "detect"
SettingValue = int | float | tuple[int | float, ...]
"""Of a setting."""


class DetectSettings(StageSettings):
    """Settings of detection, stage by stage; the defaults suit prints and renderings of all kinds.

    Frozen, equal by value, and picklable. Each setting is described, with its unit, bounds and effect, where
    it is declared (`labcal.detect.stage_settings`) and by :func:`describe_settings`.

    Attributes
    ----------
    segmentation : SegmentationSettings
        From a picture to outlines that may be dots.
    grid : GridSettings
        From outlines to a numbered grid.
    edge : EdgeSettings
        From an outline to a centre of area with its covariance.
    quality : QualitySettings
        Flags of dots and refusals of pictures.
    corner : CornerSettings
        Corners of ChArUco boards, in place of the first three.

    Examples
    --------
    >>> from labcal.detect.settings import DetectSettings
    >>> settings = DetectSettings(edge={"max_iterations": 20})
    >>> settings.changes()
    ('detect.edge.max_iterations=20',)
    """

    segmentation: SegmentationSettings = SegmentationSettings()
    grid: GridSettings = GridSettings()
    edge: EdgeSettings = EdgeSettings()
    quality: QualitySettings = QualitySettings()
    corner: CornerSettings = CornerSettings()

    def changes(self) -> tuple[str, ...]:
        """Return what differs from the defaults, as :func:`detect_settings` takes it."""
        return tuple(
            f"{setting.name}={_as_text(value)}"
            for setting in describe_settings()
            if (value := _value(self, setting.name)) != setting.default
        )


DEFAULTS = DetectSettings()
"""The settings that hold where none are given."""


@dataclass(frozen=True)
class SettingDescription:
    """One setting, for help and documentation.

    Attributes
    ----------
    name : str
        Dotted, as :func:`detect_settings` takes it: ``detect.edge.max_iterations``.
    default : int, float or tuple of them
    unit : str
    bounds : str
        For people, for example ``"2 to 1000"``.
    description : str
        Meaning and effect.
    """

    name: str
    default: SettingValue
    unit: str
    bounds: str
    description: str


def describe_settings() -> tuple[SettingDescription, ...]:
    """Return all settings of detection, stage by stage, in the order of their declaration."""
    return tuple(
        SettingDescription(
            f"{_PREFIX}.{stage}.{name}",
            field.get_default(),
            _unit(name),
            _bounds(field),
            str(field.description),
        )
        for stage in DetectSettings.model_fields
        for name, field in type(getattr(DEFAULTS, stage)).model_fields.items()
    )


def detect_settings(words: Iterable[str]) -> DetectSettings:
    """Return the settings that words of the form ``detect.STAGE.NAME=value`` change, the others as they are.

    Parameters
    ----------
    words : iterable of str
        For example ``["detect.edge.max_iterations=20", "detect.grid.fisheye_fields_deg=120,160"]``. Of two
        words about one setting the later one holds.

    Returns
    -------
    DetectSettings

    Raises
    ------
    UnknownNameError
        There is no such setting; the nearest one is offered.
    InputError
        A word has no equals sign; a value is no number, or out of bounds, or contradicts another one.

    Examples
    --------
    >>> from labcal.pipeline import detect_settings
    >>> detect_settings(["detect.edge.max_iterations=20"]).edge.max_iterations
    20
    """
    known = {setting.name: setting for setting in describe_settings()}
    given: dict[str, dict[str, object]] = {}
    for word in texts(words, "words"):
        name, equals, text = word.partition("=")
        if not equals:
            example = f"{_PREFIX}.edge.max_iterations=20"
            raise InputError(f"'{clipped(word)}' should read NAME=value, for example {example}.")
        if name not in known:
            of_stage = [other for other in known if other.startswith(f"{name.rpartition('.')[0]}.")]
            raise UnknownNameError("setting of detection", name, of_stage or known)
        _, stage, field = name.split(".")
        is_list = isinstance(known[name].default, tuple)
        given.setdefault(stage, {})[field] = text.split(",") if is_list else text.strip()
    return DEFAULTS.model_copy(
        update={stage: _checked(stage, values, known) for stage, values in given.items()}
    )


def _checked(stage: str, values: dict[str, object], known: dict[str, SettingDescription]) -> StageSettings:
    """Return the settings of a stage with some given as text."""
    try:
        kind: type[StageSettings] = type(getattr(DEFAULTS, stage))
        return kind.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        if not first["loc"]:
            reason = str(first["ctx"]["error"])
            raise InputError(f"The settings of {_PREFIX}.{stage} contradict each other: {reason}.") from error
        setting, value = known[f"{_PREFIX}.{stage}.{first['loc'][0]}"], values[str(first["loc"][0])]
        text = clipped(",".join(value) if isinstance(value, list) else str(value))
        raise InputError(
            f"{setting.name} should be {_kind(setting.default)} ({setting.bounds}; default "
            f"{_as_text(setting.default)}), not '{text}'. {setting.description}"
        ) from error


def _kind(default: SettingValue) -> str:
    """Return the words for the type of a setting."""
    if isinstance(default, tuple):
        return f"{len(default)} numbers with commas" if isinstance(default[0], int) else "numbers with commas"
    return "a whole number" if isinstance(default, int) else "a number"


def _value(settings: DetectSettings, name: str) -> SettingValue:
    """Return the value of a setting by its dotted name."""
    _, stage, field = name.split(".")
    value: SettingValue = getattr(getattr(settings, stage), field)
    return value


def _as_text(value: SettingValue) -> str:
    """Return a value as it is typed."""
    return ",".join(_as_text(part) for part in value) if isinstance(value, tuple) else f"{value!r}"


def _unit(name: str) -> str:
    """Return the unit that ends the name of a setting."""
    endings = sorted(UNITS, key=len, reverse=True)
    return next((UNITS[ending] for ending in endings if name.endswith(f"_{ending}")), "count")


def _bounds(field: FieldInfo) -> str:
    """Return the bounds of a field, or those of each entry of a tuple, for people."""
    metadata: list[Any] = list(field.metadata)
    parts = getattr(field.annotation, "__args__", ())
    if parts:
        metadata, suffix = list(getattr(parts[0], "__metadata__", ())), " each"
        metadata = [bound for part in metadata for bound in getattr(part, "metadata", [part])]
    else:
        suffix = ""
    lower = next((f"{bound.ge:g}" for bound in metadata if isinstance(bound, Ge)), None)
    lower = lower or next((f"above {bound.gt:g}" for bound in metadata if isinstance(bound, Gt)), "any")
    upper = next((f"to {bound.le:g}" for bound in metadata if isinstance(bound, Le)), None)
    upper = upper or next((f"to below {bound.lt:g}" for bound in metadata if isinstance(bound, Lt)), "")
    return f"{lower} {upper}{suffix}"
