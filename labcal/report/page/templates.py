"""The templates that the parts of a page are written with."""

from collections.abc import Callable, Mapping
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from labcal.report import figures_text


@cache
def environment() -> Environment:
    """Return the templates of ``labcal/report/templates``; whatever they are given is escaped."""
    made = Environment(
        loader=PackageLoader("labcal.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters.update(
        metres=_typographic(figures_text.signed_metres),
        percent=_typographic(figures_text.percent),
        millimetres=_typographic(figures_text.millimetres),
        epochs=_typographic(figures_text.epochs),
        goal=_typographic(figures_text.goal),
    )
    return made


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


def _typographic(write: Callable[..., str]) -> Callable[..., str]:
    """Return a way to write figures with a true minus sign and a dash for what is missing."""

    def written(value: float | int | None) -> str:  # noqa: PYI041 - the checks at run time tell them apart
        text = write(value)
        return "–" if text == figures_text.MISSING else text.replace("-", "−")  # noqa: RUF001 - meant

    return written
