"""One page for each verb of the command line, written from its own parser before the site is read."""

import argparse
from pathlib import Path

from sphinx.application import Sphinx
from tables import code, table

from labcal.cli import VERBS, build_parser

FOLDER = Path("reference", "commands")


def write_pages(app: Sphinx) -> None:
    """Write the pages; one whose verb is gone is removed, one that has not changed is left."""
    folder = app.srcdir / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    pages = {folder / f"{verb}.md": verb_page(verb) for verb in VERBS}
    for stale in set(folder.glob("*.md")) - set(pages):
        stale.unlink()
    for path, text in pages.items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def verb_page(verb: str) -> str:
    """Return the page of a verb in Markdown, with the commands that it has of its own."""
    parser = _commands(build_parser(verb))[verb]
    return "\n".join(_section(parser, VERBS[verb], level=1))


def _commands(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Return the commands under a parser by name."""
    groups = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
    return {name: command for group in groups for name, command in group.choices.items()}


def _section(parser: argparse.ArgumentParser, summary: str, level: int) -> list[str]:
    """Return the lines of one command: description, usage, arguments, options, example."""
    lines = [f"{'#' * level} {parser.prog}", ""]
    described = " ".join((parser.description or "").split())
    lines += [f"{summary[:1].upper()}{summary[1:]}.", ""] if level == 1 else []
    if described and described.rstrip(".").lower() != summary.rstrip(".").lower():
        lines += [_escaped(described), ""]
    lines += ["```text", parser.format_usage().removeprefix("usage: ").rstrip(), "```", ""]
    actions = [action for action in parser._actions if _shown(action)]
    named = [
        [code(_metavar(action)), _help(parser, action)] for action in actions if not action.option_strings
    ]
    options = [[code(_option(action)), _help(parser, action)] for action in actions if action.option_strings]
    lines += [table(["argument", "meaning"], named)] if named else []
    lines += [table(["option", "meaning"], options)] if options else []
    if parser.epilog:
        example = "\n".join(line.removeprefix("  ") for line in parser.epilog.splitlines()[1:])
        lines += ["Example:", "", "```sh", example.strip(), "```", ""]
    for command in _commands(parser).values():
        lines += _section(command, "", level + 1)
    return lines


def _shown(action: argparse.Action) -> bool:
    """Return whether help shows the action as an argument or an option."""
    hidden = action.help == argparse.SUPPRESS
    return not hidden and not isinstance(action, argparse._SubParsersAction | argparse._HelpAction)


def _metavar(action: argparse.Action) -> str:
    """Return the name of a value as the usage line has it."""
    if isinstance(action.metavar, tuple):
        return " ".join(action.metavar)
    if action.metavar is None and action.choices is not None:
        return "{" + ",".join(str(choice) for choice in action.choices) + "}"
    plain = action.dest.upper() if action.option_strings else action.dest
    return action.metavar or plain


def _option(action: argparse.Action) -> str:
    """Return an option's names with its value."""
    names = ", ".join(action.option_strings)
    return names if action.nargs == 0 else f"{names} {_metavar(action)}"


def _help(parser: argparse.ArgumentParser, action: argparse.Action) -> str:
    """Return the help of an action, as argparse fills it in."""
    return _escaped(parser._get_formatter()._expand_help(action)) if action.help else ""


def _escaped(text: str) -> str:
    """Return a plain text for Markdown: what looks like markup is shown as it is, quoted words are code."""
    for sign in "\\`*_[]<>$":
        text = text.replace(sign, f"\\{sign}")
    return text


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages when the builder starts."""
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True}
