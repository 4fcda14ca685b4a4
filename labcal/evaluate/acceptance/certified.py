"""An acceptance test: measured lengths against known ones, and the decision."""

from datetime import datetime

import numpy as np

from labcal.evaluate.acceptance.certificate import Certificate
from labcal.evaluate.acceptance.certify_settings import CertifySettings
from labcal.evaluate.acceptance.decision import Rule, Uncertainty, decided
from labcal.evaluate.acceptance.length_plan import LENGTHS, LINES, extent_warnings
from labcal.evaluate.acceptance.measured_lengths import AnyPoints, measured_lengths
from labcal.evaluate.acceptance.reference_lengths import ReferenceLengths
from labcal.wording import counted

LARGE_NOISE = 0.3
"""Of the limit, from which on noise decides about the outcome."""


def certified(given: AnyPoints, lengths: ReferenceLengths, settings: CertifySettings) -> Certificate:
    """Return the result of an acceptance test; as :func:`labcal.pipeline.certify`."""
    measured = measured_lengths(given, lengths)
    known = np.isfinite(measured.length_mm)
    variance = lengths.sigma_mm**2
    if settings.uncertainty == Uncertainty.REPEATED:
        variance = variance + np.nan_to_num(measured.noise_sigma_mm) ** 2
    sigma = np.sqrt(variance[known])
    error, nominal = (measured.length_mm - lengths.nominal_mm)[known], lengths.nominal_mm[known]
    decision = decided(error, settings.limits_mm(nominal), sigma, Rule(settings.rule), settings.confidence)
    date = settings.date or datetime.now().astimezone().date().isoformat()
    found = Certificate(lengths, measured, decision, settings, date, ())
    return Certificate(lengths, measured, decision, settings, date, tuple(_warnings(found)))


def _warnings(found: Certificate) -> list[str]:
    """Return what a certificate does not hold."""
    measured, settings, lines = found.measured, found.settings, found.reference.line
    warnings = list(measured.warnings)
    if measured.missing:
        count = int((~found.is_measured).sum())
        warnings.append(f"{counted(count, 'length')} not measured; the first one: {measured.missing[0]}")
    if not found.is_complete:
        of = len(set(lines[found.is_measured].tolist()))
        measured_on = f"{counted(int(found.is_measured.sum()), 'length')} on {counted(of, 'line')}"
        warnings.append(
            f"{measured_on} measured, where {LENGTHS} on each of {LINES} lines are asked: the test is "
            "incomplete. `plan` tells where to put them"
        )
    if settings.sides_mm is not None:
        known = found.is_measured
        warnings += extent_warnings(settings.sides_mm, lines[known], found.reference.nominal_mm[known])
    if settings.rule == Rule.GUARDED and settings.limit_mm is not None and not found.reference.sigma_mm.any():
        warnings.append(
            "the calibrated lengths count as exact, since no sigma_mm is stated: what is decided holds if "
            "their uncertainty is small against the limit"
        )
    noise = float(np.nan_to_num(measured.noise_sigma_mm).max())
    if settings.limit_mm is not None and noise > LARGE_NOISE * settings.limit_mm:
        warnings.append(
            f"the noise of the pixels alone makes errors with standard deviations of up to {noise:.2g} mm: a "
            "repetition may come out otherwise"
        )
    return warnings
