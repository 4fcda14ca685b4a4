"""Figures of protocols over the seeds, beside those that were published."""

from collections.abc import Iterator, Sequence

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.bench.distortion.protocols.case import ProtocolCase
from labcal.bench.distortion.protocols.figures import ORACLE, ProtocolCaseFigures, ProtocolMethodFigures
from labcal.bench.distortion.protocols.protocol import Protocol
from labcal.bench.distortion.protocols.registry import protocol_by_name
from labcal.report.values import Measured as Figure

_NAN = float("nan")


class ProtocolFigure(BaseModel):
    """One quantity of one method, over the seeds."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    quantity: str
    unit: str
    """``1`` of a share."""
    median: Figure
    low: Figure
    """Least of the seeds."""
    high: Figure
    """Greatest of the seeds."""


class ProtocolMethod(BaseModel):
    """One method by one protocol."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    method: str
    """A method, or `exact cameras`."""
    figures: tuple[ProtocolFigure, ...]
    coverage95: Figure
    """Median over the seeds; null where no covariance is stated."""
    flagged: int
    """Seeds that are flagged `model-misfit`."""
    seeds: int
    reasons: tuple[str, ...]
    """Reasons why seeds have no figures, each once."""


class PublishedFigure(BaseModel):
    """A figure of the authors."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    method: str
    quantity: str
    unit: str
    value: float
    words: str


class ProtocolResult(BaseModel):
    """All methods by one protocol, and what its authors published."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    protocol: str
    source: str
    methods: tuple[ProtocolMethod, ...]
    published: tuple[PublishedFigure, ...]
    same: tuple[str, ...]
    """Conditions that are as in the publication."""
    different: tuple[str, ...]
    """Conditions that are not, or are not known."""


Found = tuple[ProtocolCase, ProtocolCaseFigures | str]
"""A case, and its figures or the reason why it has none."""


def protocol_results(found: Sequence[Found]) -> list[ProtocolResult]:
    """Return the figures by protocol, in the order of the cases."""
    groups: dict[str, list[Found]] = {}
    for one in found:
        groups.setdefault(one[0].protocol, []).append(one)
    return [_result(protocol_by_name(name), group) for name, group in groups.items()]


def by_method(case: ProtocolCase, figures: ProtocolCaseFigures | str) -> Iterator[ProtocolMethodFigures]:
    """Yield the figures of exact cameras and of every method, or the reason of the case for each."""
    if isinstance(figures, ProtocolCaseFigures):
        yield from figures.methods
        return
    for method in (ORACLE, *case.methods):
        yield ProtocolMethodFigures(method=method, reason=figures)


def _result(protocol: Protocol, group: Sequence[Found]) -> ProtocolResult:
    methods: dict[str, list[ProtocolMethodFigures]] = {}
    for case, figures in group:
        for one in by_method(case, figures):
            methods.setdefault(one.method, []).append(one)
    units = {quantity.name: quantity.unit for quantity in protocol.quantities}
    return ProtocolResult(
        protocol=protocol.name,
        source=protocol.source,
        methods=tuple(_method(protocol, own) for own in methods.values()),
        published=tuple(
            PublishedFigure(
                method=one.method,
                quantity=one.quantity,
                unit=units[one.quantity],
                value=one.value,
                words=one.words,
            )
            for one in protocol.published
        ),
        same=protocol.same,
        different=protocol.different,
    )


def _method(protocol: Protocol, seeds: Sequence[ProtocolMethodFigures]) -> ProtocolMethod:
    known = [one for one in seeds if one.reason is None]
    values = np.array([one.values for one in known]).reshape(len(known), len(protocol.quantities))
    return ProtocolMethod(
        method=seeds[0].method,
        figures=tuple(
            _figure(quantity.name, quantity.unit, values[:, at])
            for at, quantity in enumerate(protocol.quantities)
        ),
        coverage95=_figure("", "", np.array([one.coverage95 for one in known])).median,
        flagged=sum(one.misfit is True for one in known),
        seeds=len(seeds),
        reasons=tuple(dict.fromkeys(one.reason for one in seeds if one.reason is not None)),
    )


def _figure(quantity: str, unit: str, values: np.ndarray) -> ProtocolFigure:
    values = values[np.isfinite(values)]
    low, median, high = np.quantile(values, (0.0, 0.5, 1.0)).tolist() if len(values) else (_NAN,) * 3
    return ProtocolFigure(quantity=quantity, unit=unit, median=median, low=low, high=high)
