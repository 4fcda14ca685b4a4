"""Detection in many pictures, spread over an executor."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from labcal.arguments import object_of, wrong_type
from labcal.correspond.board_parts import place_parts
from labcal.correspond.detections import Detections
from labcal.correspond.gathering import gather
from labcal.correspond.orientation import resolve_orientation
from labcal.correspond.picture_work import over_pictures, read_and
from labcal.correspond.refused_pictures import no_picture_left
from labcal.correspond.sources import Source
from labcal.detect.dots import PictureDots
from labcal.detect.settings import DetectSettings
from labcal.public_object import PublicObject
from labcal.run.progress import Progress
from labcal.shoot.luma import measured_light
from labcal.shoot.tone_curve import AnyToneCurve, ToneCurve
from labcal.targets.catalogue import AnyTarget
from labcal.targets.code_text import PrintedTarget


@dataclass(frozen=True, eq=False, repr=False)
class Measurement(PublicObject):
    """The result of one picture."""

    source: Source
    dots: PictureDots | None
    """None where the file could not be read."""
    reason: str | None
    """The reason why the picture has no ids; None if it has."""

    @property
    def indexed(self) -> bool:
        """True if the dots of this picture have ids."""
        return self.reason is None

    def _summary(self) -> Mapping[str, object]:
        found = {"dots": 0 if self.dots is None else len(self.dots.flag)}
        why = {} if self.reason is None else {"reason": self.reason}
        return {"view": self.source.view, "camera": self.source.camera, **found, **why}


def measure_picture(
    source: Source,
    target: AnyTarget | PrintedTarget,
    tone_curve: AnyToneCurve = ToneCurve.LINEAR,
    settings: DetectSettings | None = None,
) -> Measurement:
    """Read a picture and measure it in the light that made it.

    A file that cannot be read, or not be used, is a result with a reason. Of a print that its code or its
    number tells, dots are found on its own board only; of a target that was named, tags are looked for only
    in pictures that would be refused without.
    """
    from labcal.detect.codes.own_board import own_board_only, own_board_where_seen  # noqa: PLC0415 -- cv2
    from labcal.detect.codes.part_by_code import placed_by_code  # noqa: PLC0415 -- the same
    from labcal.detect.detector import detect_dots  # noqa: PLC0415 -- imports Numba, which tables do not need

    def measured(picture: np.ndarray) -> Measurement:
        light = measured_light(source.image, picture, tone_curve)
        if isinstance(target, PrintedTarget):
            dots = detect_dots(own_board_only(light, target), target.target, settings)
            return _measurement(source, placed_by_code(light, dots, target))
        dots = detect_dots(light, target, settings)
        if dots.refusal is not None:
            own = own_board_where_seen(light, target)
            if own is not light:
                dots = placed_by_code(light, detect_dots(own, target, settings), PrintedTarget(target))
        return _measurement(source, dots)

    return read_and(source, measured, _lost)


def _lost(source: Source, reason: str) -> Measurement:
    """Return the result of a picture that cannot be used."""
    return Measurement(source, None, reason)


def _measurement(source: Source, dots: PictureDots) -> Measurement:
    """Return the detections, with a reason if the picture is refused."""
    reason = None if dots.refusal is None else f"{dots.refusal}: {dots.why}"
    return Measurement(source, dots, reason)


def measure_pictures(
    sources: Sequence[Source],
    target: AnyTarget | PrintedTarget,
    executor: Executor,
    progress: Progress,
    tone_curve: AnyToneCurve = ToneCurve.LINEAR,
    settings: DetectSettings | None = None,
) -> list[Measurement]:
    """Measure pictures, in the order of `sources` whatever the order of work.

    A picture that ends each worker process that measures it (it makes a library crash, or takes all memory)
    is a result with a reason, as one that cannot be read: the other pictures are as good as without it.
    The tone curve is undone first; linear: the values are taken for light as they are. The settings are those
    of :func:`labcal.detect.detector.detect_dots`, in every process.
    Where the dots are all alike, the cameras' numberings are made to agree (`labcal.correspond.orientation`),
    and parts are placed by a camera that sees the board whole (`labcal.correspond.board_parts`).
    """
    progress.start("detecting dots", len(sources))
    cases = [(source, target, tone_curve, settings) for source in sources]
    return agreed(over_pictures(executor, measure_picture, cases, _lost, progress), target)


def agreed(found: Sequence[Measurement], target: AnyTarget | PrintedTarget) -> list[Measurement]:
    """Return measurements of pictures, each measured by itself, with numberings that agree among them."""
    readable = [measurement for measurement in found if measurement.dots is not None]
    pictures = [measurement.dots for measurement in readable if measurement.dots is not None]
    design = target.target if isinstance(target, PrintedTarget) else target
    sources = [measurement.source for measurement in readable]
    resolved = iter(place_parts(sources, resolve_orientation(sources, pictures, design), design))
    return [
        measurement if measurement.dots is None else _measurement(measurement.source, next(resolved))
        for measurement in found
    ]


def refusals(measurements: Sequence[Measurement]) -> list[tuple[str, str]]:
    """Return pictures without ids, in the given order, with reasons."""
    return [(found.source.image, found.reason) for found in measurements if found.reason is not None]


def detections_of(measurements: Sequence[Measurement]) -> Detections:
    """Return one table of all dots in the pictures that could be read.

    Parameters
    ----------
    measurements : sequence of Measurement
        As :func:`labcal.pipeline.measure_pictures` returns them.

    Returns
    -------
    Detections
        In the order of the pictures; positions in px.

    Raises
    ------
    InputError
        None could be read.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> measured = pipeline.measure_pictures(examples.shoot("shoot", views=1))
    >>> pipeline.detections_of(measured)
    Detections(views=1, cameras=['left', 'right'], dots=176, ok=176)
    """
    if isinstance(measurements, str) or not isinstance(measurements, Sequence):
        raise wrong_type(measurements, "a sequence of measurements", "measurements")
    measurements = [object_of(one, Measurement, "measurements") for one in measurements]
    readable = [(found.source, found.dots) for found in measurements if found.dots is not None]
    if not readable:
        raise no_picture_left(refusals(measurements))
    return gather([source for source, _ in readable], [dots for _, dots in readable])
