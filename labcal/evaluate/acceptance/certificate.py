"""The result of an acceptance test."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from labcal.evaluate.acceptance.certify_settings import CertifySettings
from labcal.evaluate.acceptance.decision import Decision, Outcome
from labcal.evaluate.acceptance.length_plan import LENGTHS, LINES
from labcal.evaluate.acceptance.measured_lengths import MeasuredLengths
from labcal.evaluate.acceptance.reference_lengths import ReferenceLengths
from labcal.extras import optional_module
from labcal.public_object import HtmlTable, PublicObject

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas


@dataclass(frozen=True, eq=False, repr=False)
class Certificate(PublicObject):
    """Length errors against a limit, and what follows.

    Attributes
    ----------
    reference : ReferenceLengths
    measured : MeasuredLengths
    decision : Decision
        Of the lengths that were measured.
    settings : CertifySettings
    date : str
        Of the test.
    warnings : tuple of str

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples
    >>> from labcal.pipeline import CertifySettings
    >>> settings = CertifySettings(limit_mm=0.5)
    >>> labcal.certify(examples.pixels(), examples.lengths(), settings, rig=examples.rig())
    Certificate(outcome=incomplete, lengths=3, largest_error=0.0258 mm, limit=0.5 mm, warnings=1)
    """

    reference: ReferenceLengths
    measured: MeasuredLengths
    decision: Decision
    settings: CertifySettings
    date: str
    warnings: tuple[str, ...]

    @property
    def is_measured(self) -> np.ndarray:
        """(n,) of bool: lengths with both ends measured."""
        return np.asarray(np.isfinite(self.measured.length_mm))

    @property
    def error_mm(self) -> Float64[np.ndarray, " n"]:
        """Measured minus calibrated lengths, mm; NaN of those that were not measured."""
        return np.asarray(self.measured.length_mm - self.reference.nominal_mm)

    @property
    def largest(self) -> int:
        """Number of the length with the largest absolute error."""
        return int(np.nanargmax(np.abs(self.error_mm)))

    @property
    def expected_sigma_mm(self) -> Float64[np.ndarray, " n"]:
        """Standard deviation of each error by noise, calibration and reference; NaN if one is not known."""
        m = self.measured
        parts = m.noise_sigma_mm**2 + m.calibration_sigma_mm**2 + self.reference.sigma_mm**2
        return np.asarray(np.sqrt(parts))

    @property
    def is_complete(self) -> bool:
        """True if all listed lengths were measured, and five or more on each of seven lines."""
        per_line = Counter(self.reference.line[self.is_measured].tolist())
        enough = sum(count >= LENGTHS for count in per_line.values()) >= LINES
        return enough and bool(self.is_measured.all())

    @property
    def outcome(self) -> Outcome:
        """The outcome of the test."""
        if self.settings.limit_mm is None:
            return Outcome.NO_LIMIT
        whole = self.decision.whole
        return whole if self.is_complete or whole is Outcome.NOT_CONFORMING else Outcome.INCOMPLETE

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line for each length, mm.

        Raises
        ------
        DeviceError
            pandas is not installed.

        Examples
        --------
        >>> import labcal
        >>> from labcal import examples
        >>> found = labcal.certify(examples.pixels(), examples.lengths(), rig=examples.rig())
        >>> found.to_pandas()["nominal_mm"].round(1).tolist()
        [100.0, 90.0, 70.7]
        """
        frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(length_columns(self))
        return frame

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw the errors over the lengths, mm, with two standard deviations by noise and reference.

        Examples
        --------
        >>> import labcal
        >>> from labcal import examples
        >>> found = labcal.certify(examples.pixels(), examples.lengths(), rig=examples.rig())
        >>> found.plot().axes[0].get_xlabel()
        'calibrated length (mm)'
        """
        from labcal.evaluate.acceptance.certificate_figure import (  # noqa: PLC0415 -- imports matplotlib
            certificate_figure,
        )

        return certificate_figure(self)

    def _summary(self) -> Mapping[str, object]:
        limit = self.settings.limit_mm
        return {
            "outcome": self.outcome.value,
            "lengths": int(self.is_measured.sum()),
            "largest_error": f"{self.error_mm[self.largest]:.3g} mm",
            "limit": None if limit is None else f"{limit:g} mm",
            "warnings": len(self.warnings),
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        columns = length_columns(self)
        shown = ("line", "length", "nominal_mm", "measured_mm", "error_mm", "outcome")
        cells = [[_cell(value) for value in columns[name]] for name in shown]
        return [
            HtmlTable(shown, [list(row) for row in zip(*cells, strict=True)]),
            HtmlTable(("warnings",), [[warning] for warning in self.warnings]),
        ]


def length_columns(found: Certificate) -> dict[str, np.ndarray]:
    """Return all figures of the lengths as columns of a table."""
    reference, measured, known = found.reference, found.measured, found.is_measured
    within, outcome = np.full(len(known), np.nan), np.full(len(known), "not-measured", dtype="<U20")
    beyond = within.copy()
    if found.settings.limit_mm is not None:
        within[known], beyond[known] = found.decision.guard_within, found.decision.guard_beyond
        outcome[known] = found.decision.outcome
    else:
        outcome[known] = Outcome.NO_LIMIT.value
    return {
        "line": reference.line,
        "length": reference.length,
        "nominal_mm": reference.nominal_mm,
        "measured_mm": measured.length_mm,
        "error_mm": found.error_mm,
        "noise_sigma_mm": measured.noise_sigma_mm,
        "reference_sigma_mm": reference.sigma_mm,
        "calibration_sigma_mm": measured.calibration_sigma_mm,
        "limit_mm": found.settings.limits_mm(reference.nominal_mm),
        "guard_within_mm": within,
        "guard_beyond_mm": beyond,
        "outcome": outcome,
    }


def _cell(value: object) -> str:
    return f"{value:.4f}" if isinstance(value, float) else str(value)
