"""Mutations of files: of their bytes, of their words, of the tree that JSON and YAML are, and of models."""

import copy
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random
from typing import Any

import yaml


class Raw(str):
    """A text that is written as it is where a value is due."""

    __slots__ = ()


@dataclass(frozen=True)
class Mutant:
    """A mutated file."""

    data: bytes
    what: str
    """What was done, for people."""
    must_refuse: bool = False
    """Whether no careful reader would take it."""


HUGE = ("1e30", "1e200", "-1e200", "1e308", str(2**63), "9" * 5000)
"""Numbers that nothing in any file can be."""
NO_NUMBERS = ("nan", "inf", "-inf")
ODD = ("-1", "0", "-0.0", "1e-300", "0.5", "2147483647", "65536", "1e5", "-1e5")
WORDS = (
    "", "x" * 5000, "a\x1b[31mred\x1b[0m", "a\x07b", "\u202egnp", "a\u0085b\x9b2J",
    "=cmd()", "+1+1", "@SUM(1)",
    "-1", "'=1", "../../etc/passwd", "<script>alert(1)</script>", "\ud83d\ude00", "nul\0l", "a\nb",
    "null", "1", "left,right", "{{ 7 * 7 }}", "$\\frac{", "$$", "%s%n", "-rf",
)  # fmt: skip
FREE_TEXT = {"description", "caption", "reading", "mistake_description", "claim"}


def _leaves(node: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(node, dict):
        for key, value in node.items():
            yield from _leaves(value, (*path, key))
    elif isinstance(node, list):
        for number, value in enumerate(node):
            yield from _leaves(value, (*path, number))
    else:
        yield path


def _at(tree: Any, path: tuple[Any, ...]) -> Any:
    for step in path:
        tree = tree[step]
    return tree


def _nodes(node: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(node, dict | list):
        yield path
        for key, value in node.items() if isinstance(node, dict) else enumerate(node):
            yield from _nodes(value, (*path, key))


def _text(node: Any) -> str:
    """Return a tree as JSON, with raw texts as they are and keys twice where a pair list says so."""
    if isinstance(node, Raw):
        return str(node)
    if isinstance(node, dict):
        return "{" + ", ".join(f"{json.dumps(str(key))}: {_text(value)}" for key, value in node.items()) + "}"
    if isinstance(node, list):
        return "[" + ", ".join(map(_text, node)) + "]"
    return json.dumps(node)


def _number(word: str, language: str) -> Raw:
    """Return a number as a language writes it."""
    names = {"nan": ("NaN", ".nan"), "inf": ("Infinity", ".inf"), "-inf": ("-Infinity", "-.inf")}
    written = names.get(word, (word, word))[language == "yaml"]
    return Raw(written.replace("e30", "e+30").replace("e200", "e+200") if "e" in written else written)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_matrix(node: object) -> bool:
    return (
        isinstance(node, list)
        and len(node) in {3, 4}
        and all(isinstance(row, list) and len(row) == len(node) and all(map(_is_number, row)) for row in node)
    )


def mutate_tree(text: str, language: str, rng: Random) -> Mutant:
    """Mutate one place of a JSON or YAML document."""
    tree = json.loads(text) if language == "json" else yaml.safe_load(text)
    tree = copy.deepcopy(tree)
    matrices = [path for path in _nodes(tree) if path and _is_matrix(_at(tree, path))]
    paths = list(_leaves(tree))
    roll = rng.random()
    if matrices and roll < 0.12:
        return _matrix(tree, rng.choice(matrices), rng)
    if roll < 0.2:
        return _structure(tree, language, rng)
    path = rng.choice(paths)
    parent, last, old = _at(tree, path[:-1]), path[-1], _at(tree, path)
    where = ".".join(map(str, path))
    if _is_number(old) and rng.random() < 0.75:
        kind = rng.choice((HUGE, NO_NUMBERS, ODD))
        word = rng.choice(kind)
        parent[last] = _number(word, language)
        # pydantic takes -0 and 0 for each other, and some numbers may be nothing.
        return Mutant(_text(tree).encode(), f"{where} = {word[:20]}", kind is not ODD)
    choice = rng.randrange(5)
    if choice == 0:
        parent[last] = rng.choice([[], {}, None, True, [old], {"a": old}, Raw("[" * 1000 + "]" * 1000)])
    elif choice == 1:
        parent[last] = Raw("[" * 100_000 + "]" * 100_000)
    else:
        parent[last] = rng.choice(WORDS)
    return Mutant(_text(tree).encode("utf-8", "surrogatepass"), f"{where} = {str(parent[last])[:30]!r}")


def _matrix(tree: Any, path: tuple[Any, ...], rng: Random) -> Mutant:
    """Make a matrix none of a camera or a pose: reflected, stretched, sheared, of NaN."""
    matrix = _at(tree, path)
    what = rng.choice(["reflect", "scale", "shear", "zero", "last row", "far"])
    if what == "reflect":
        matrix[0] = [-value for value in matrix[0]]
    elif what == "scale":
        matrix[:3] = [[1.01 * value for value in row] for row in matrix[:3]]
    elif what == "shear":
        matrix[0][1] += 0.01
    elif what == "zero":
        matrix[:3] = [[0.0 for _ in row] for row in matrix[:3]]
    elif what == "last row":
        matrix[-1][0] = 0.5
    else:
        matrix[0][-1] = 1e15
    # A K whose first row is 1% larger is another camera.
    harmless = len(matrix) == 3 and what == "scale"
    return Mutant(_text(tree).encode(), f"{'.'.join(map(str, path))}: {what}", not harmless)


def _structure(tree: Any, language: str, rng: Random) -> Mutant:
    """Lose, double, exchange or add parts."""
    path = rng.choice(list(_nodes(tree)))
    node = _at(tree, path)
    where = ".".join(map(str, path)) or "all"
    if isinstance(node, list) and node:
        at = rng.randrange(len(node))
        what = rng.choice(["lose", "double", "many"])
        node[at : at + 1] = {"lose": [], "double": [node[at]] * 2, "many": [node[at]] * 3000}[what]
        return Mutant(_text(tree).encode(), f"{where}: {what}")
    if isinstance(node, dict) and node:
        key = rng.choice(list(node))
        what = rng.choice(["lose", "rename", "twice", "merge"])
        value = node[key]
        if what == "lose":
            del node[key]
        elif what == "rename":
            node[rng.choice(WORDS)] = node.pop(key)
        elif what == "twice":
            doubled = Raw(f"{_text(value)}, {json.dumps(str(key))}: {_text(value)}")
            node[key] = doubled
        elif language == "yaml":
            node[key] = Raw(rng.choice(_TRICKS))
        else:
            node[key] = Raw("")
        must = what == "twice" or (what == "merge" and language == "json")
        return Mutant(_text(tree).encode("utf-8", "surrogatepass"), f"{where}.{key}: {what}", must)
    return Mutant(b"", "emptied")


_TRICKS = ("*a", "&a [1, *a]", "!!python/object:os.system x", "2001-99-99", "1:60:99")


def laughs(rng: Random) -> Mutant:
    """Return a YAML text of aliases that unfold to millions of entries."""
    width = rng.choice((9, 10))
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * width)}]" for i in range(1, 9)]
    return Mutant("\n".join(lines).encode(), "billion laughs", True)


_WORD = re.compile(rb"-?\d+\.?\d*(?:[eE][-+]?\d+)?|[A-Za-z_][A-Za-z_0-9-]+")


def mutate_words(data: bytes, rng: Random) -> Mutant:
    """Change a word or a number of a text, or its lines."""
    roll = rng.random()
    lines = data.splitlines(keepends=True)
    if roll < 0.25 and len(lines) > 1:
        at = rng.randrange(len(lines))
        what = rng.choice(["lose", "double", "swap", "cut"])
        if what == "lose":
            del lines[at]
        elif what == "double":
            lines.insert(at, lines[at])
        elif what == "swap":
            other = rng.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        else:
            lines[at] = lines[at][: len(lines[at]) // 2] + b"\n"
        return Mutant(b"".join(lines), f"line {at}: {what}")
    words = list(_WORD.finditer(data))
    if not words:
        return Mutant(b"", "emptied")
    word = rng.choice(words)
    number = word[0][:1].isdigit() or word[0][:1] == b"-"
    new = rng.choice((*HUGE, *NO_NUMBERS, *ODD) if number else WORDS)
    new_bytes = new.encode("utf-8", "surrogatepass")
    return Mutant(data[: word.start()] + new_bytes + data[word.end() :], f"{word[0]!r} -> {new[:30]!r}")


def mutate_bytes(data: bytes, rng: Random) -> Mutant:
    """Change bytes without knowing what they are."""
    at, other = rng.randrange(len(data) + 1), rng.randrange(len(data) + 1)
    results = {
        "flip": lambda: _flipped(data, rng),
        "truncate": lambda: data[:at],
        "splice": lambda: data[:at] + data[other : other + rng.randrange(200)] + data[at:],
        "insert": lambda: data[:at] + rng.randbytes(rng.choice((1, 8, 300))) + data[at:],
        "utf-16": lambda: data.decode("latin-1").encode("utf-16"),
        "bom": lambda: b"\xef\xbb\xbf" + data,
        "crlf": lambda: data.replace(b"\n", b"\r\n"),
        "empty": lambda: b"",
        "zeros": lambda: data[:at] + bytes(min(64, len(data) - at)) + data[at + 64 :],
        "double": lambda: data * 2,
    }
    what = rng.choice(sorted(results))
    return Mutant(results[what](), f"{what} at {at}")


def _flipped(data: bytes, rng: Random) -> bytes:
    """Return bytes of which some bits are turned."""
    turned = bytearray(data)
    for _ in range(rng.choice((1, 3, 20)) if data else 0):
        turned[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return bytes(turned)
