"""Statements and verdicts on data with a known answer."""

import numpy as np
import pytest
from scipy.stats import binom

from labcal.paper.claims.statement import Evidence, Statement, evidence_of
from labcal.paper.claims.verdict import Verdict, decisions
from labcal.rng import generator

FACTOR = 1.25
BOUND = float(np.log10(FACTOR))
EXPERIMENTS = 1000


def _tested(centre: float, statement: Statement, random: np.random.Generator, n: int = 12) -> Evidence:
    return evidence_of(random.normal(centre, 0.05, n), statement, FACTOR)


@pytest.mark.parametrize(
    ("statement", "centre", "supported"),
    [
        (Statement.AT_MOST, BOUND - 0.2, True),
        (Statement.AT_MOST, BOUND + 0.2, False),
        (Statement.MORE_THAN, BOUND + 0.2, True),
        (Statement.MORE_THAN, BOUND - 0.2, False),
        (Statement.EQUIVALENT, 0.0, True),
        (Statement.EQUIVALENT, 0.3, False),
        (Statement.EQUIVALENT, -0.3, False),
    ],
)
def test_what_is_plain_is_decided(statement: Statement, centre: float, *, supported: bool) -> None:
    found = _tested(centre, statement, generator(3, "test statement", statement))
    assert found.p <= 0.00625
    assert found.supported is supported


def test_holds_only_where_and_undecided() -> None:
    random = generator(5, "test verdicts")
    plain = _tested(BOUND - 0.2, Statement.AT_MOST, random)
    refuted = _tested(BOUND + 0.2, Statement.AT_MOST, random)
    close = evidence_of(BOUND + np.array([-1, 1, -2, 2, -3, 3.5]) / 10, Statement.AT_MOST, FACTOR)
    found = decisions({"C1": [plain], "C2": [refuted, refuted], "C3": [plain, refuted], "C4": [plain, close]})
    assert [one.verdict for one in found.values()] == [
        Verdict.HOLDS,
        Verdict.FAILS,
        Verdict.PARTLY,
        Verdict.UNDECIDED,
    ]
    assert found["C4"].p == close.p


def test_eight_pairs_cannot_decide_eight_claims_and_ten_can() -> None:
    for n, verdict in ((8, Verdict.UNDECIDED), (10, Verdict.HOLDS)):
        one = evidence_of(np.linspace(-1.0, -0.5, n), Statement.AT_MOST, FACTOR)
        assert {found.verdict for found in decisions({key: [one] for key in "abcdefgh"}).values()} == {
            verdict
        }


@pytest.mark.slow
@pytest.mark.parametrize("statement", list(Statement))
def test_a_statement_at_its_bound_is_decided_rarely(statement: Statement) -> None:
    """The false positive rate of 1,000 experiments lies within its binomial interval."""
    random = generator(7, "test level", statement)
    decided = [_tested(BOUND, statement, random, n=10).p <= 0.05 for _ in range(EXPERIMENTS)]
    exact = 2 * 25 / 1024  # the level that ten pairs can reach
    low, high = binom.interval(0.999, EXPERIMENTS, exact)
    if statement is Statement.EQUIVALENT:  # its tests are conservative: twice a test that is one already
        low = 0
    assert low <= sum(decided) <= high


@pytest.mark.slow
@pytest.mark.parametrize("shared", [0.0, 0.9])
def test_any_of_eight_claims_is_wrong_in_five_percent(shared: float) -> None:
    """Every comparison lies at its bound, where each decision is wrong; claims share pairs or do not."""
    random = generator(9, "test family", str(shared))
    wrong = 0
    for _ in range(EXPERIMENTS):
        common = random.normal(0.0, 1.0, 10)
        pairs = shared * common + np.sqrt(1 - shared**2) * random.normal(0.0, 1.0, (8, 10))
        claims = {str(k): [evidence_of(BOUND + d, Statement.AT_MOST, FACTOR)] for k, d in enumerate(pairs)}
        wrong += any(one.verdict is not Verdict.UNDECIDED for one in decisions(claims).values())
    assert 0 < wrong <= binom.interval(0.999, EXPERIMENTS, 0.05)[1]


def test_an_effect_that_matters_is_found() -> None:
    """Nine of ten experiments with 12 pairs find a ratio of 1.25 * 1.25 that scatters by 15%."""
    random = generator(11, "test power")
    found = 0
    for _ in range(200):
        tested = evidence_of(random.normal(2 * BOUND, 0.06, 12), Statement.AT_MOST, FACTOR)
        found += tested.p <= 0.05 / 8 and not tested.supported
    assert found >= 180
