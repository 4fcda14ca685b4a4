from pathlib import Path

import pytest

from labcal.bounds import MOST_NUMBER
from labcal.cli import build_parser
from labcal.cli.options import add_output, add_seed, add_workers
from labcal.cli.parser import Parser, UsageError
from labcal.run.machine import usable_cores


@pytest.fixture
def parser() -> Parser:
    parser = Parser(prog="x")
    add_output(parser, "DIR", "the folder")
    add_seed(parser)
    add_workers(parser)
    return parser


def test_what_is_not_given_is_seed_0_and_all_cores(parser: Parser) -> None:
    found = parser.parse_args(["-o", "out"])
    assert (found.output, found.force, found.seed, found.workers) == (Path("out"), False, 0, usable_cores())


@pytest.mark.parametrize(
    "words",
    [
        ["--seed", "-1"],
        ["--seed", "x"],
        ["--seed", str(MOST_NUMBER + 1)],
        ["--workers", "0"],
        ["--workers", "1.5"],
    ],
)
def test_numbers_that_cannot_be_are_refused(words: list[str], parser: Parser) -> None:
    with pytest.raises(UsageError, match=f"Argument {words[0]}"):
        parser.parse_args(["-o", "out", *words])


def test_the_largest_number_is_that_of_arguments_in_python(parser: Parser) -> None:
    assert parser.parse_args(["-o", "out", "--seed", str(MOST_NUMBER)]).seed == MOST_NUMBER


def test_an_output_is_needed(parser: Parser) -> None:
    with pytest.raises(UsageError, match="-o/--output"):
        parser.parse_args([])


def test_a_value_may_begin_with_a_hyphen() -> None:
    words = ["detect", "a", "--target", "t", "-o", "d.csv", "--cameras", "-l=left,-r=right", "--workers", "1"]
    arguments = build_parser("detect").parse_args(words)
    assert arguments.cameras == "-l=left,-r=right"
    assert arguments.workers == 1


def test_an_option_is_no_value_of_the_one_before() -> None:
    words = ["detect", "a", "--cameras", "--target", "t", "-o", "d.csv"]
    with pytest.raises(UsageError, match="Argument --cameras: expected one argument"):
        build_parser("detect").parse_args(words)


@pytest.mark.parametrize("verb", ["convert", "measure", "diagnose", "twin"])
def test_a_command_of_one_target_refuses_a_second_one(verb: str) -> None:
    with pytest.raises(UsageError, match="--target is given twice"):
        build_parser(verb).parse_args([verb, "x", "y", "--target", "a", "--target", "b"])
