"""The templates that the parts of a page are written with."""

from collections.abc import Mapping
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup


@cache
def environment() -> Environment:
    """Return the templates of ``labcal/report/templates``; whatever they are given is escaped."""
    return Environment(
        loader=PackageLoader("labcal.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def rendered(template: str, values: Mapping[str, object]) -> Markup:
    """Return what a template makes of values, as HTML that is not escaped again.

    Parameters
    ----------
    template : str
        The name of its file.
    values : mapping of str to object
        By the names that the template knows them by.
    """
    return Markup(environment().get_template(template).render(values))  # noqa: S704 -- templates escape
