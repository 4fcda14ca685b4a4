"""Mutations of fitted models: signed anew, so that their digest tells nothing."""

import hashlib
import json
import struct
from random import Random
from typing import Any

from fuzz.mutators import Mutant, mutate_tree


def mutate_model(data: bytes, rng: Random) -> Mutant:
    """Change a number or the header of a fitted model, and sign it anew so that its digest holds."""
    (length,) = struct.unpack("<Q", data[:8])
    header = json.loads(data[8 : 8 + length])
    body = bytearray(data[8 + length :])
    own = json.loads(header["__metadata__"]["labcal"])
    must = False
    if rng.random() < 0.6:
        name = rng.choice(sorted(key for key in header if key != "__metadata__"))
        begin, end = header[name]["data_offsets"]
        count = (end - begin) // 8
        value = rng.choice([float("nan"), float("inf"), -float("inf"), 1e308, 1e200, -1e150, 1e30, 0.0, -1.0])
        for at in [rng.randrange(count)] if rng.random() < 0.5 and count else range(count):
            struct.pack_into("<d", body, begin + 8 * at, value)
        what, must = f"{name} = {value}", not abs(value) < 1e150
        must = must and count > 0
    else:
        parts = mutate_tree(json.dumps(own), "json", rng)
        text = parts.data.decode("utf-8", "surrogatepass")
        what, must = f"header: {parts.what}", parts.must_refuse
        try:
            own = json.loads(text)
        except (ValueError, RecursionError):
            own = text
        if must and isinstance(own, dict):
            must = False  # a digest of what Python made of it
    if isinstance(own, dict):
        own = {**own, "digest": _digest(own, header, body)}
        header["__metadata__"]["labcal"] = json.dumps(own, sort_keys=True)
    else:
        header["__metadata__"]["labcal"] = own
    packed = json.dumps(header).encode("utf-8", "replace")
    packed += b" " * (-len(packed) % 8)
    return Mutant(struct.pack("<Q", len(packed)) + packed + bytes(body), what, must)


def _digest(own: dict[str, Any], header: dict[str, Any], body: bytearray) -> str:
    """Return the digest that the program itself would write."""
    blank = {**own, "digest": ""}
    digest = hashlib.sha256(json.dumps(blank, sort_keys=True).encode("utf-8", "replace"))
    for name in sorted(key for key in header if key != "__metadata__"):
        begin, end = header[name]["data_offsets"]
        digest.update(f"{name} <f8 {tuple(header[name]['shape'])}".encode())
        digest.update(bytes(body[begin:end]))
    return digest.hexdigest()
