"""A candidate of a search: the number of a particle and, in the bits above it, its image along each axis.

Words are unsigned, since numba makes reals of signed ones that meet these.
"""

from numpy import int64, uint64

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.model import IMAGE_BITS, NUMBER_BITS

NUMBER = uint64((1 << NUMBER_BITS) - 1)  # the bits of a candidate that name the particle
X, Y, Z = (uint64(NUMBER_BITS + IMAGE_BITS * k) for k in range(3))  # the first bit of the image along an axis
_IMAGE, _ONE = uint64((1 << IMAGE_BITS) - 1), uint64(1)
_LOW = (_ONE << X) | (_ONE << Y) | (_ONE << Z)


@inner_helper
def number_of(candidate):
    """The number of the particle."""
    return int64(candidate & NUMBER)


@inner_helper
def image_bits(image, first):
    """The bits, from `first` on, that stand for the image -1, 0 or 1 of a candidate along an axis."""
    return (uint64(image) & _IMAGE) << first


@inner_helper
def image_of(candidate, first):
    """The image that the bits of a candidate from `first` on stand for."""
    return (int64((candidate >> first) & _IMAGE) ^ 2) - 2


@inner_helper
def offset_of(candidate, space):
    """(3,) the displacement of the image of a candidate."""
    lengths = space.lengths
    return (
        image_of(candidate, X) * lengths[0],
        image_of(candidate, Y) * lengths[1],
        image_of(candidate, Z) * lengths[len(lengths) - 1],
    )


@inner_helper
def opposite(image):
    """The image bits of one particle seen from another, of which `image` is seen from the first."""
    return image ^ (image & _LOW) << _ONE
