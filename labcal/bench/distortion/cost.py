"""Expected time of a plan, stated before it starts."""

from labcal.bench.distortion.checks import HYBRID
from labcal.bench.distortion.plan import Plan
from labcal.bench.distortion.protocols.registry import PROTOCOLS
from labcal.bench.settings import BenchSettings
from labcal.errors import InputError
from labcal.run.machine import usable_cores
from labcal.run.pace import BUSY, core_pace, crowding
from labcal.wording import counted

_SECONDS = {
    "hybrid": (2.0, 20.0),
    "bundle": (0.5, 0.0),
    "two-plane": (0.5, 0.5),
    "dlt": (0.1, 0.0),
    "quadratic": (0.05, 0.0),
    "affine": (0.05, 0.0),
    "mlp": (0.3, 30.0),
    "mlp-bayes": (20.0, 200.0),
    "ray-net": (30.0, 100.0),
}
"""Of one case on one core: what it takes at least, and what a thousand points add, by the square of their
number. `bundle` takes the cameras of `hybrid`."""
_OTHER = (1.0, 10.0)
_PICTURE, _RAYS = 1.0, 0.04
"""Seconds of a picture: what the sensor and the detector take, and each ray a pixel."""
LONG_S = 4.0 * 3600.0
"""Duration beyond which work is begun only on request."""
_MINUTE, _HOUR, _DAY, _YEAR = 60.0, 3600.0, 86400.0, 365.25 * 86400.0


def expected_seconds(plan: Plan, workers: int) -> float:
    """Return how long a plan takes on the idle reference machine (`labcal.run.pace`)."""
    simulated = sum(_fitting_seconds(plan, points) for points in plan.points)
    simulated *= plan.cell_count * plan.seeds / len(plan.points)
    simulated += plan.fault_case_count * _fitting_seconds(plan, max(plan.points))
    for protocol in (PROTOCOLS[name] for name in plan.protocols):
        simulated += plan.seeds * (protocol.seconds + _fitting_seconds(plan, protocol.trained))
    if plan.rendered is None:
        return simulated / workers
    pictured = plan.rendered.picture_count * (_PICTURE + _RAYS * plan.rendered.spp)
    pictured += _fitting_seconds(plan, plan.rendered.points)
    return (simulated + pictured * plan.rendered.case_count) / workers


def _fitting_seconds(plan: Plan, points: int) -> float:
    """Return how long all methods, and `hybrid` in any case, take on one core for a number of points."""
    share = (points / 1000.0) ** 2
    fitted = {*plan.methods, HYBRID}  # whose cameras are the surrogate that flags come from
    return sum(least + more * share for least, more in (_SECONDS.get(m, _OTHER) for m in sorted(fitted)))


def plain_time(seconds: float) -> str:
    """Return a duration for people."""
    for unit, name in ((_YEAR, "years"), (_DAY, "days"), (_HOUR, "hours"), (_MINUTE, "minutes")):
        if seconds >= 2.0 * unit:
            return f"{seconds / unit:,.0f} {name}"
    return counted(max(round(seconds), 1), "second")


def announcement(plan: Plan, scheduler: str | None = None) -> str:
    """Return the number of cases and the expected time, for people.

    The time is that of this machine now: how fast it is and what else it does are measured, so that the same
    plan may take longer a minute later. Of a cluster only the work is known, and not who does it.

    Parameters
    ----------
    plan : Plan
    scheduler : str, optional
        Of a cluster: an address, or ``"local"``.
    """
    count = plan.case_count + plan.seeds * len(plan.protocols)
    cases = f"{count:,} {'case' if count == 1 else 'cases'} of {counted(len(plan.methods), 'method')}"
    if _is_elsewhere(scheduler):
        return f"{cases}: about {plain_time(expected_seconds(plan, 1))} of work for one core, on a cluster"
    cores = usable_cores()
    alone = expected_seconds(plan, cores) * core_pace()
    crowded = crowding(cores, alone)
    needed = plain_time(alone * crowded)
    busy = ", which other programs use, too" if crowded > BUSY else ""
    return f"{cases}: about {needed} on {counted(cores, 'core')}{busy}"


def require_consent(plan: Plan, settings: BenchSettings) -> None:
    """Raise where a plan takes very long here, and nobody has said that it may.

    A cluster at an address is asked nothing of: who has one wants long work done.

    Raises
    ------
    InputError
        It takes more than `LONG_S`, as far as is known.
    """
    if settings.yes or _is_elsewhere(settings.scheduler):
        return
    if expected_seconds(plan, usable_cores()) > LONG_S:  # of the reference machine: the answer is always one
        raise InputError(
            f"This is long work: {announcement(plan)}. Add `yes=True` to begin it, or measure less: "
            "`quick=True`, fewer levels (`overrides`), fewer `seeds`. A `scheduler` shares it among machines."
        )


def _is_elsewhere(scheduler: str | None) -> bool:
    return scheduler not in {None, "local"}
