"""The sections of the page, in the order in which they stand; a new one is a line here."""

from labcal.bench.distortion.page.checks_section import checks_section
from labcal.bench.distortion.page.coverage_section import coverage_section
from labcal.bench.distortion.page.detections_section import detections_section
from labcal.bench.distortion.page.error_section import error_section
from labcal.bench.distortion.page.findings import MakeSection
from labcal.bench.distortion.page.learning_section import learning_section
from labcal.bench.distortion.page.outside_section import outside_section
from labcal.bench.distortion.page.plan_section import plan_section
from labcal.bench.distortion.page.protocols_section import protocols_section
from labcal.bench.distortion.page.rendered_section import rendered_section
from labcal.bench.distortion.page.sensitivity_section import sensitivity_section
from labcal.bench.distortion.page.trust_section import trust_section
from labcal.bench.distortion.page.winners_section import winners_section

SECTIONS: tuple[MakeSection, ...] = (
    trust_section,
    error_section,
    winners_section,
    learning_section,
    coverage_section,
    outside_section,
    rendered_section,
    sensitivity_section,
    protocols_section,
    detections_section,
    checks_section,
    plan_section,
)
