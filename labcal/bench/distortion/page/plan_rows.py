"""The plan of a result as rows of a table."""

from collections.abc import Mapping

from labcal.bench.distortion.result import DistortionResult


def plan_rows(result: DistortionResult) -> list[list[str]]:
    """Return the plan of a result, a row for each factor, and its hash.

    Parameters
    ----------
    result : DistortionResult
    """
    plan = result.plan
    # As it is dumped: factors that are added to plans come by themselves.
    factors = plan.model_dump(mode="json", exclude={"description", "settings", "seeds"})
    rows = [[factor, _levels(value)] for factor, value in factors.items()]
    rows.append(["seeds", f"{plan.seeds}, from {result.first_seed}"])
    for method, settings in plan.settings.items():
        rows.append([f"settings of {method}", setting_words(settings)])
    return [*rows, ["SHA-256", result.plan_sha256]]


def setting_words(settings: Mapping[str, object]) -> str:
    """Return constructor arguments of a method in words.

    Parameters
    ----------
    settings : mapping of str to object
    """
    return ", ".join(f"{name} {value}" for name, value in settings.items())


def _levels(value: object) -> str:
    if isinstance(value, list | tuple):
        return ", ".join(f"{one:g}" if isinstance(one, float) else str(one) for one in value)
    return str(value)
