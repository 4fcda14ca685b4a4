"""Decisions of the acceptance test against the truth, with limits near the largest error.

Each case calibrates a simulated pair anew, measures the 35 lengths of a plan, and states limits that lie near
the true largest error. A decision is wrong if conformity is stated and the true largest error is beyond the
limit, or the other way round; ``undecided`` is not wrong, but must not be the answer where the limit is far.
"""

from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.budget_rigs import KINDS, PairKind
from labcal.bench.solve.budget_set import CAMERAS, NOISE_PX, PRINTS, BudgetSet, simulated_dots
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.correspond.named_points import NamedPoints
from labcal.evaluate.acceptance.certified import certified
from labcal.evaluate.acceptance.certify_settings import CertifySettings
from labcal.evaluate.acceptance.decision import Outcome, Uncertainty
from labcal.evaluate.acceptance.length_plan import LengthPlan, plan_lengths
from labcal.evaluate.acceptance.measured_lengths import measured_lengths
from labcal.evaluate.acceptance.reference_lengths import ReferenceLengths
from labcal.report.bench import Check, Figure, at_most
from labcal.report.values import Measured
from labcal.rng import generator
from labcal.run.cases import run_cases

SETS, QUICK_SETS = 14, 4
"""Of each kind of pair."""
VIEWS = 12
MOST_WRONG = 0.05
_SIDES = (1.0, 0.7, 0.2)
"""Of the volume, in units of the reach twice, and of the distance."""
_REFERENCE = 0.05
"""Standard uncertainty of calibrated lengths, in units of the largest error."""
_NEAR = 8.0
"""Standard uncertainties within which limits lie on both sides of the true largest error."""
_CLEAR = 5.0
"""The same, beyond which a case should be decided: both guard bands and the error in them."""


@dataclass(frozen=True)
class CertifyCase:
    """A case: kind of pair, and seed."""

    kind: str
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.kind}-{self.seed}"


class Decided(BaseModel):
    """One decision, and the truth."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    outcome: str
    conforms: bool
    """The true largest error is within the limit."""
    off: Measured
    """Limit minus true largest error in standard uncertainties of the test: those of the worst length where
    it does not conform, else those of the most uncertain one."""


class CertifyFigures(BaseModel):
    """Decisions of one case by kind of uncertainty."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    decided: dict[str, Decided]


def certify_findings(bench: Bench) -> Findings:
    """Return the share of wrong decisions, and of clear cases that are left undecided."""
    seeds = range(bench.seed, bench.seed + (QUICK_SETS if bench.quick else SETS))
    cases = [CertifyCase(kind, seed) for kind in KINDS for seed in seeds]
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, certified_case, CertifyFigures, bench.folder / "certificates", executor, bench.progress
        )
    checks, references = list[Check](), list[Figure]()
    for kind in Uncertainty:
        decided = [one.decided[kind.value] for one in found]
        name = f"certify, {len(decided)} cases near the limit, {kind.value}"
        wrong = [is_wrong(one) for one in decided]
        checks.append(at_most(f"{name}: share of wrong decisions", float(np.mean(wrong)), MOST_WRONG))
        clear = [one.outcome == Outcome.UNDECIDED.value for one in decided if abs(one.off) > _CLEAR]
        share = float(np.mean(clear)) if clear else 0.0
        checks.append(at_most(f"{name}: share of clear cases undecided", share, MOST_WRONG))
        open_ = float(np.mean([one.outcome == Outcome.UNDECIDED.value for one in decided]))
        references.append(Figure(name=f"{name}: share undecided", value=open_))
    return Findings(checks, references)


def is_wrong(one: Decided) -> bool:
    """Tell whether a decision states what is not true."""
    stated = {Outcome.CONFORMING.value: True, Outcome.NOT_CONFORMING.value: False}
    return one.outcome in stated and stated[one.outcome] is not one.conforms


def certified_case(case: CertifyCase) -> CertifyFigures:
    """Simulate, calibrate, measure a plan's lengths, and decide about limits near the true errors."""
    kind = KINDS[case.kind]
    random = generator(case.seed, "bench solve", "certify", case.kind)
    set_ = BudgetSet(case.kind, PRINTS[0], VIEWS, "brown5", case.seed)
    dots, settings = simulated_dots(kind, set_, random), HandheldSettings(eccentricity_rounds=0)
    rig = calibrate_handheld(dots, kind.target(), "brown5", settings).rig
    cameras = [rig.camera(name) for name in CAMERAS]
    sides = np.array(_SIDES) * [2.0 * kind.reach_mm, 2.0 * kind.reach_mm, kind.distance_mm]
    plan = plan_lengths(sides)
    exact, noisy = (_measured(kind, cameras, plan, noise) for noise in (None, random))
    return CertifyFigures(
        decided={
            kind_.value: _decided(kind_, plan, (exact, noisy), random)
            for kind_ in Uncertainty
        }
    )  # fmt: skip


def _measured(
    kind: PairKind, cameras: list[Camera], plan: LengthPlan, noise: np.random.Generator | None
) -> NamedPoints:
    """Return the ends of the lengths by the calibrated cameras, from pixels with noise or without."""
    middle = np.array([0.0, 0.0, kind.distance_mm])
    p = np.concatenate([plan.end_a, plan.end_b]) + middle
    q = np.stack([camera.project(p).q for camera in kind.cameras()], axis=1)
    if noise is not None:
        q += NOISE_PX * noise.standard_normal(q.shape)
    found = triangulate(cameras, q, np.tile(NOISE_PX**2 * np.eye(2), (len(q), 2, 1, 1)))
    views, n = plan.lengths().view_a, len(plan.end_a)
    return NamedPoints(
        np.tile(views, 2), np.repeat(["a", "b"], n), found.point, found.covariance, np.full(2 * n, "ok")
    )


def _decided(
    kind: Uncertainty, plan: LengthPlan, points: tuple[NamedPoints, NamedPoints], random: np.random.Generator
) -> Decided:
    """Return one decision: about errors that stay, or about those that were measured."""
    exact, noisy = points
    true, form, n = plan.nominal_mm, plan.lengths(), len(plan.end_a)
    judged = exact if kind is Uncertainty.REPEATED else noisy
    error = np.abs(np.linalg.norm(judged.point[:n] - judged.point[n:], axis=1) - true)
    worst = int(np.argmax(error))
    sigma = _REFERENCE * float(error[worst])
    nominal = true + sigma * random.standard_normal(n)
    reference = ReferenceLengths(
        form.line,
        form.length,
        form.view_a,
        form.point_a,
        form.view_b,
        form.point_b,
        nominal,
        np.full(n, sigma),
    )
    of_test = np.full(n, sigma)
    if kind is Uncertainty.REPEATED:
        of_test = np.hypot(of_test, measured_lengths(noisy, reference).noise_sigma_mm)
    off = random.uniform(-_NEAR, _NEAR)
    # One length is enough not to conform; to conform, the most uncertain one must, too.
    unit = float(of_test.max() if off > 0.0 else of_test[worst])
    limit = max(float(error[worst]) + off * unit, 0.05 * float(error[worst]))
    settings = CertifySettings(limit_mm=limit, uncertainty=kind, date="2026-01-01")
    outcome = certified(noisy, reference, settings).outcome
    return Decided(
        outcome=outcome.value,
        conforms=bool(error[worst] <= limit),
        off=(limit - float(error[worst])) / unit,
    )
