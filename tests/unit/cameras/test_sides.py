import pytest

from labcal.cameras.sides import are_sides, left_first, words_in


@pytest.mark.parametrize(
    ("right", "left"),
    [
        ("derecha", "izquierda"),
        ("destra.yml", "sinistra.yml"),
        ("Droite", "Gauche"),
        ("direita", "esquerda"),
        ("cam_dx", "cam_sx"),
        ("camR", "camL"),
        ("rightCam", "leftCam"),
        ("右", "左"),
        ("höger", "vänster"),
    ],
)
def test_the_left_one_is_told_in_many_languages(right: str, left: str) -> None:
    assert left_first([right, left]) == [left, right]
    assert left_first([left, right]) == [left, right]
    assert left_first([right, right]) is None


def test_other_names_tell_no_side() -> None:
    assert left_first(["front", "back"]) is None
    assert left_first(["left", "right", "top"]) is None
    assert left_first(["left_scene", "right_pose"]) is None
    assert left_first(["left", "derecha"]) is None
    assert not are_sides({"left", "gauche"})
    assert are_sides({"Ho\u0308ger", "va\u0308nster"})
    assert words_in("LeftCam-2 ABc") == ["left", "cam", "a", "bc"]
