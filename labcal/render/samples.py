"""Sample positions in pixels, lamps and apertures: scrambled (0, 2)-sequences.

Any power of two of consecutive points has one in every elementary interval of the square (Sobol 1967; Kollig
and Keller 2002 for the scrambling by exclusive or). Every pixel has its own scrambling from the seed, so that
neither the size of a band of rows nor the number of passes changes a sample.

The order of the points of each purpose is drawn by nested permutations (Laine and Karras 2011; Burley 2020),
which keep blocks of consecutive points together. An exclusive or of the index is not enough: the samples in
one half of a pixel would all choose the same half of a lamp, and the light of a pixel at an edge would not
converge.
"""

from labcal.render.variant import Jit

_BITS = 32
_TO_UNIT = 2.0**-24
"""float32 holds 24 bits, so that no sample is rounded up to 1."""


class Samples:
    """The samples of a wavefront, `count` per pixel, in succession.

    Parameters
    ----------
    mi : module
        Mitsuba with the variant in use.
    pixel : UInt32
        Number of each lane's pixel in its picture.
    index : UInt32
        Number of each lane's sample within the pixel.
    seed : UInt32
        Of the picture.
    count : int
        Samples a pixel altogether; how many bits of `index` matter.
    """

    def __init__(self, mi: Jit, pixel: Jit, index: Jit, seed: Jit, count: int) -> None:
        self._mi, self._pixel, self._index, self._seed = mi, pixel, index, seed
        self._bits = max(1, (count - 1).bit_length())

    def square(self, purpose: int) -> Jit:
        """Return a point of the unit square for each lane; different purposes give independent points."""
        mi = self._mi
        scramble_x, scramble_y = mi.sample_tea_32(self._pixel, self._seed + purpose, 4)
        # Which sample of one purpose meets which of another is drawn for every pixel, too.
        shuffle, _ = mi.sample_tea_32(scramble_y, self._pixel, 4)
        index = _shuffled(mi, self._index, shuffle) & mi.UInt32((1 << self._bits) - 1)
        x, y = mi.UInt32(0), mi.UInt32(0)
        direction = 1 << (_BITS - 1)
        for bit in range(self._bits):
            chosen = (index >> bit) & 1
            x ^= chosen * mi.UInt32(1 << (_BITS - 1 - bit))
            y ^= chosen * mi.UInt32(direction)
            direction ^= direction >> 1
        x, y = (x ^ scramble_x) >> 8, (y ^ scramble_y) >> 8
        return mi.Point2f(mi.Float(x) * _TO_UNIT, mi.Float(y) * _TO_UNIT)


def _shuffled(mi: Jit, index: Jit, seed: Jit) -> Jit:
    """Return indices in an order of which each bit is flipped by a hash of the bits above it."""
    import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm

    x = dr.brev(index) + seed
    x ^= x * 0x6C50B47C
    x ^= x * 0xB82F1E52
    x ^= x * 0xC7AFE638
    x ^= x * 0x8D22F6E6
    return mi.UInt32(dr.brev(x))
