"""Kinds of marks by name, and several kinds in one picture."""

import numpy as np
import pytest

from labcal.bench.marks.specimen import CODE, DICTIONARY, specimen
from labcal.detect.marks.mark_kinds import CodedMarks, PlainDots, Tags, mark_kinds, mark_names
from labcal.detect.marks.several_kinds import find_marks
from labcal.detect.settings import DEFAULTS
from labcal.errors import InputError, UnknownNameError
from labcal.targets.charuco import MarkerDictionary
from labcal.targets.coded_dots import CodedDots
from labcal.targets.ring_codes import RingCode


@pytest.mark.parametrize("name", ["apriltag-36h11", "AprilTag-36h11", "DICT_APRILTAG_36h11"])
def test_a_dictionary_has_the_name_of_its_points_and_opencvs(name: str) -> None:
    assert mark_kinds([name]) == (Tags(MarkerDictionary.DICT_APRILTAG_36H11),)


def test_every_name_that_is_listed_is_a_kind_of_its_own() -> None:
    kinds = mark_kinds(mark_names())
    assert len(kinds) == len(mark_names()) == len(MarkerDictionary) + len(RingCode) + 1
    assert isinstance(kinds[-1], PlainDots)


def test_a_sheet_knows_its_code_its_marks_and_their_diameter() -> None:
    (kind,) = mark_kinds(["coded-8x6"])
    assert isinstance(kind, CodedMarks)
    assert (kind.family, kind.diameter_mm) == ("ring-23", 5.0)


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (["ring-23", "coded-8x6"], "both marks of 'ring-23'"),
        (["apriltag-36h11", "DICT_APRILTAG_36H11"], "both marks of 'apriltag-36h11'"),
        (["rings-10x8"], "no marks that are found one by one"),
        ([], "No kind of marks"),
    ],
)
def test_what_is_no_choice_of_marks_is_told(names: list[str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        mark_kinds(names)


def test_a_name_that_is_nearly_right_is_suggested() -> None:
    with pytest.raises(UnknownNameError, match=r"Did you mean 'apriltag-36h11'.*coded-8x6"):
        mark_kinds(["apriltag-36h12"])


def test_rings_and_tags_hold_no_plain_dots_and_a_sheet_has_its_own_marks_alone() -> None:
    made = specimen(0, 3, 4, 3)
    picture = made.pictures["left"]
    found = find_marks(picture, mark_kinds(["dots", DICTIONARY.value, CODE.value]))
    names = {name.rpartition("-")[0] if name.startswith("apriltag") else name for name in found.point if name}
    assert sum(name.startswith("dot-") for name in names) == len(made.plain) == 4
    assert sum(name.startswith("ring-23-") for name in names) == 4
    assert sum(name.startswith("apriltag-") for name in names) == 4
    marks = sorted(int(name.rpartition("-")[2]) for name in names if name.startswith("ring"))
    size = {"cols": 1, "rows": 1, "pitch_mm": 30.0, "dot_diameter_mm": 6.0}
    sheet = CodedDots(kind="coded-dots", name="one", code=CODE, first_mark=marks[1], **size)
    own = CodedMarks(CODE, sheet).find(picture.astype(np.float32), DEFAULTS)
    assert [name for name in own.point if name] == [f"ring-23-{marks[1]}"]
