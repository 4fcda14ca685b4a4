"""All settings of detection in one object, and their names for the command line and the documentation."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, ValidationError

from labcal.arguments import texts
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.detect.stage_settings.edge import EdgeSettings
from labcal.detect.stage_settings.grid import GridSettings
from labcal.detect.stage_settings.mark import MarkSettings
from labcal.detect.stage_settings.quality import QualitySettings
from labcal.detect.stage_settings.saddle import SaddleSettings
from labcal.detect.stage_settings.segmentation import SegmentationSettings
from labcal.detect.stage_settings.setting import PREFIX, SettingDescription, SettingValue, as_text, describe
from labcal.detect.stage_settings.stage import StageSettings
from labcal.errors import InputError, InputTypeError, LabcalError, UnknownNameError
from labcal.wording import clipped, shown


class DetectSettings(BaseModel):
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
        Corners of ChArUco boards and chessboards, in place of the first three.
    mark : MarkSettings
        Rings of coded dots.
    saddle : SaddleSettings
        The search for the corners of chessboards, and their marks.

    Raises
    ------
    UnknownNameError
        There is no such stage, or no such setting of one.
    InputError
        A value is of another type, is out of bounds, or contradicts another one.
    InputTypeError
        A stage is neither settings nor a mapping.

    Examples
    --------
    >>> from labcal.detect.settings import DetectSettings
    >>> settings = DetectSettings(edge={"max_iterations": 20})
    >>> settings.changes()
    ('detect.edge.max_iterations=20',)
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    segmentation: SegmentationSettings = SegmentationSettings()
    grid: GridSettings = GridSettings()
    edge: EdgeSettings = EdgeSettings()
    quality: QualitySettings = QualitySettings()
    corner: CornerSettings = CornerSettings()
    mark: MarkSettings = MarkSettings()
    saddle: SaddleSettings = SaddleSettings()

    if not TYPE_CHECKING:  # which knows what may be given from the fields

        def __init__(self, **given: object) -> None:
            try:
                super().__init__(**given)
            except ValidationError as error:
                raise _refusal(given, error) from error

    def changes(self) -> tuple[str, ...]:
        """Return what differs from the defaults, as :func:`detect_settings` takes it."""
        return tuple(
            f"{setting.name}={as_text(value)}"
            for setting in describe_settings()
            if (value := _value(self, setting.name)) != setting.default
        )


DEFAULTS = DetectSettings()
"""The settings that hold where none are given."""


def describe_settings() -> tuple[SettingDescription, ...]:
    """Return all settings of detection, stage by stage, in the order of their declaration."""
    return tuple(
        setting
        for stage in DetectSettings.model_fields
        for setting in describe(stage, _of_stage(stage).model_fields)
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
            example = f"{PREFIX}.edge.max_iterations=20"
            raise InputError(f"'{clipped(word)}' should read NAME=value, for example {example}.")
        if name not in known:
            of_stage = [other for other in known if other.startswith(f"{name.rpartition('.')[0]}.")]
            raise UnknownNameError("setting of detection", name, of_stage or known)
        _, stage, field = name.split(".")
        is_list = isinstance(known[name].default, tuple)
        parts = [] if not text.strip() else text.split(",")
        given.setdefault(stage, {})[field] = parts if is_list else text.strip()
    return DetectSettings(**{stage: _of_stage(stage)(**values) for stage, values in given.items()})


def _of_stage(stage: str) -> type[StageSettings]:
    """Return the class of a stage's settings."""
    kind: type[StageSettings] = type(getattr(DEFAULTS, stage))
    return kind


def _refusal(given: dict[str, object], error: ValidationError) -> LabcalError:
    """Return the error that states what is wrong with the settings of a stage."""
    fault = error.errors(include_url=False)[0]
    stage = str(fault["loc"][0])
    reason = fault.get("ctx", {}).get("error")
    if isinstance(reason, LabcalError):
        return reason
    if stage not in DetectSettings.model_fields:
        stages = [f"{PREFIX}.{known}" for known in DetectSettings.model_fields]
        return UnknownNameError("stage of detection", f"{PREFIX}.{stage}", stages)
    return InputTypeError(
        f"{PREFIX}.{stage} should be {_of_stage(stage).__name__}, or a mapping of names to values, not "
        f"{shown(given[stage])}."
    )


def _value(settings: DetectSettings, name: str) -> SettingValue:
    """Return the value of a setting by its dotted name."""
    _, stage, field = name.split(".")
    value: SettingValue = getattr(getattr(settings, stage), field)
    return value
