"""Words for the left and the right camera of a pair, in several languages."""

import re
import unicodedata
from collections.abc import Collection

SIDES = (
    ("left", "right"), ("l", "r"), ("lft", "rgt"), ("lt", "rt"), ("links", "rechts"), ("linke", "rechte"),
    ("gauche", "droite"), ("izquierda", "derecha"), ("izquierdo", "derecho"), ("izq", "der"),
    ("sinistra", "destra"), ("sinistro", "destro"), ("sx", "dx"), ("esquerda", "direita"), ("esq", "dir"),
    ("левая", "правая"), ("левый", "правый"), ("лев", "прав"), ("lewa", "prawa"), ("leva", "prava"),
    ("venstre", "høyre"), ("venstre", "højre"), ("vänster", "höger"), ("vasen", "oikea"), ("sol", "sağ"),
    ("bal", "jobb"), ("左", "右"), ("왼쪽", "오른쪽"),
)  # fmt: skip
"""The left one, and the right one."""
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[^\W\d_A-Z]+|[^\W\d_]")


def plain_word(text: str) -> str:
    """Return a word in small letters without accents, in which it is compared: ``camara`` of ``Cámara``."""
    apart = unicodedata.normalize("NFKD", text)
    return "".join(letter for letter in apart if not unicodedata.combining(letter)).casefold()


_PLAIN = tuple((plain_word(left), plain_word(right)) for left, right in SIDES)


def words_in(name: str) -> list[str]:
    """Return the words of a name, plain, also of ``LeftCam``."""
    return [plain_word(word) for word in _WORD.findall(unicodedata.normalize("NFC", name))]


def are_sides(words: Collection[str]) -> bool:
    """Tell whether words are a left and a right one of one language."""
    found = {plain_word(word) for word in words}
    return len(words) == 2 and any(found == set(pair) for pair in _PLAIN)  # noqa: PLR2004 -- a pair


def left_first(names: Collection[str]) -> list[str] | None:
    """Return two names, that of the left camera first; None where they do not tell the sides.

    Parameters
    ----------
    names : collection of str
        As ``derecha.yml`` and ``izquierda.yml``, or ``cam_R`` and ``cam_L``.
    """
    if len(names) != 2:  # noqa: PLR2004 -- a pair
        return None
    one, two = names
    of_one, of_two = words_in(one), words_in(two)
    for left, right in _PLAIN:
        for first, order in ((left, [one, two]), (right, [two, one])):
            second = right if first == left else left
            if of_one.count(first) == 1 and [second if word == first else word for word in of_one] == of_two:
                return order
    return None
