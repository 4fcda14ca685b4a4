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
from labcal.bench.solve.budget_set import NOISE_PX, PRINTS, BudgetSet, simulated_dots
from labcal.bench.solve.certify_decision import (
    MOST_WRONG,
    Decided,
    clear_cases,
    decided_near_limit,
    is_wrong,
    share_undecided,
)
from labcal.bench.solve.certify_rendered import certify_rendered_findings
from labcal.bench.solve.pair_dots import CAMERAS
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.correspond.named_points import NamedPoints
from labcal.evaluate.acceptance.decision import Uncertainty
from labcal.evaluate.acceptance.length_plan import LengthPlan, plan_lengths
from labcal.report.bench import Check, Figure, at_most
from labcal.rng import generator
from labcal.run.cases import run_cases

SETS, QUICK_SETS = 14, 4
"""Of each kind of pair."""
VIEWS = 12
_SIDES = (1.0, 0.7, 0.2)
"""Of the volume, in units of the reach twice, and of the distance."""


@dataclass(frozen=True)
class CertifyCase:
    """A case: kind of pair, and seed."""

    kind: str
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.kind}-{self.seed}"


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
        share = share_undecided(clear_cases(decided))
        checks.append(at_most(f"{name}: share of clear cases undecided", share, MOST_WRONG))
        references.append(Figure(name=f"{name}: share undecided", value=share_undecided(decided)))
    rendered = certify_rendered_findings(bench)
    return Findings([*checks, *rendered.checks], [*references, *rendered.references])


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
            kind_.value: decided_near_limit(kind_, plan, (exact, noisy), random)
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
