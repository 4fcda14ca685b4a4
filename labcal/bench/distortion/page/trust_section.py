"""Section: words on the reliability of each method."""

import numpy as np

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.trust_words import trust_entries
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose, Terms, Tone
from labcal.wording import listed

_ORACLE = (
    "The oracle triangulates the same noisy pixels with the true cameras: nothing can be much better. An "
    "error of 1 is the oracle's. Strength 0 is a pinhole camera, strength 1 the family at its worst."
)


def _oracle_words(findings: Findings) -> list[str]:
    """Return the oracle's error in mm by noise, which turns ratios into mm; none where no cell has it."""
    words = []
    for noise in findings.result.plan.noise_px:
        errors = [
            one.oracle_mm
            for one in findings.summaries
            if one.cell.is_usual and one.measured == Measured.WITHIN and one.cell.noise_px == noise
        ]
        if known := [error for error in errors if np.isfinite(error)]:
            low, high = f"{min(known):.2g}", f"{max(known):.2g}"
            words.append(f"{low if low == high else f'{low} to {high}'} mm at {noise:g} px of noise")
    return [f"The oracle's RMS error is {listed(words)}."] if words else []


def trust_section(findings: Findings) -> Section:
    """Return what each method can be trusted for, computed from its figures.

    Parameters
    ----------
    findings : Findings
    """
    points = (
        f"These words are about the strengths of the plan, in cells with {findings.enough} training points "
        "or more, over all noises and layouts. The flag model-misfit says that a method errs by more than "
        "noise explains, or that its covariances are too small; labcal raises it from training data alone."
    )
    return Section(
        "How far each method can be trusted",
        [
            Prose((_ORACLE, *_oracle_words(findings))),
            Terms(tuple(trust_entries(findings.result))),
            Prose((points,), Tone.QUIET),
        ],
    )
