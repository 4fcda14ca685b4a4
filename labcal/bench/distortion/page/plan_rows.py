"""The plan of a result as rows of a table."""

from collections.abc import Mapping

from labcal.bench.distortion.result import DistortionResult

_NONE = "none"


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
    """Return levels in words; a section of the plan has those of its keys that it sets."""
    if isinstance(value, Mapping):
        given = {key: one for key, one in value.items() if one is not None and one != []}
        return "; ".join(f"{key} {_levels(one)}" for key, one in given.items()) or _NONE
    if isinstance(value, list | tuple):
        return ", ".join(f"{one:g}" if isinstance(one, float) else str(one) for one in value) or _NONE
    return _NONE if value is None else str(value)
