"""The plan that settings of a benchmark of distortion ask for."""

from labcal.bench.distortion.case import Case
from labcal.bench.distortion.cost import announcement
from labcal.bench.distortion.measuring import prepared
from labcal.bench.distortion.plan import FULL, QUICK, Plan, load_plan
from labcal.bench.distortion.rendered_plan import RenderedPlan, is_rendered_change
from labcal.bench.settings import BenchSettings
from labcal.errors import InputError
from labcal.paths import as_text
from labcal.render.llvm import ensure_llvm

MOST_CASES = 200_000
"""Of one run. More would take months, and their results do not fit into memory."""


def plan_of(settings: BenchSettings) -> Plan:
    """Return the plan of settings, checked as far as that is possible before it starts.

    Raises
    ------
    UnknownNameError
        There is no such plan, factor, family or method.
    InputError
        A level is not allowed, a setting of a method is not known, or there are too many cases.
    DeviceError
        There is no LLVM library for the renderer.
    """
    name = QUICK if settings.quick else FULL
    if settings.plan is not None:
        if settings.quick:
            raise InputError(
                "`quick=True` and `plan` both name a plan, and only one can be measured. Leave one out."
            )
        name = as_text(settings.plan)
    plan = load_plan(name, settings.overrides, settings.methods, settings.seeds)
    plan = plan.model_copy(update={"rendered": _rendered_plan(plan, settings)})
    if plan.case_count > MOST_CASES:
        announced = announcement(plan, settings.scheduler)
        raise InputError(
            f"The plan '{name}' has {announced}. At most {MOST_CASES:,} cases are measured at a time: leave "
            "levels or seeds out, or share it out among several plans."
        )
    for method in plan.settings:
        if method not in plan.methods:
            raise InputError(f"The plan '{name}' has settings of '{method}', which it does not measure.")
    first = next(iter(plan.cells()))
    case = Case(first, settings.seed, plan.methods, plan.measured, plan.tests, plan.settings)
    for method in plan.methods:
        prepared(case, method)  # tells now, not after an hour, whether there is such a method
    return plan


def _rendered_plan(plan: Plan, settings: BenchSettings) -> RenderedPlan | None:
    """Return the section of cases through pictures where they are asked for.

    Raises
    ------
    InputError
        They are changed and not asked for.
    DeviceError
        There is no LLVM library for the renderer.
    """
    if settings.rendered:
        if settings.scheduler is None:
            ensure_llvm()
        return plan.rendered or RenderedPlan()
    changed = [change for change in settings.overrides if is_rendered_change(change)]
    if changed:
        raise InputError(
            f"`overrides` sets '{changed[0]}', which concerns pictures, but none are asked for: give "
            "`rendered=True`, too, or leave it out."
        )
    return None
