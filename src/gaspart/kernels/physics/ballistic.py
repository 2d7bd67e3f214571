"""Contact times of falling particles, which are roots for flights under a uniform acceleration.

Two particles that fall with the same acceleration move uniformly relative to each other. Therefore these
roots are needed only if the second object does not fall: a wall, a face of a box, a fixed particle, or a
particle on a floor. As in `contact`, the contact time is 0 for objects that touch and approach, and every
root is computed without cancellation.
"""

from math import inf, sqrt

from gaspart.kernels.compile.policy import helper, inner_helper, kernel

_HALVINGS = 2200  # maximum number of bisections; fewer suffice to narrow any interval to two adjacent floats


@inner_helper
def advance_coordinate(x, v, pull, time):
    """Return a coordinate after ballistic flight (Spencer 2022, Eq. 1)."""
    return x + (v + 0.5 * pull * time) * time


@helper
def time_against(gap, speed, pull):
    """Return the time to cross `gap` at `speed` >= 0 against a deceleration `pull` > 0. This is the smaller
    root of pull t^2 / 2 - speed t + gap = 0 (Spencer 2022, Eqs. 12 and 14); inf if the particle turns before
    it has crossed the gap.
    """
    if gap <= 0.0:
        return 0.0
    square = speed * speed - 2.0 * pull * gap
    if square < 0.0:
        return inf
    return 2.0 * gap / (speed + sqrt(square))


@helper
def time_along(gap, speed, pull):
    """Return the time to cross a `gap` in the direction of an acceleration `pull` > 0. This is the larger
    root of gap - speed t - pull t^2 / 2 = 0. If rounding leaves the gap closed (< 0) at the turning point, as
    for a particle that has just left a floor, the result is the time of the turning point. `speed`: initial
    speed; negative if directed away from the end of the gap.
    """
    if speed >= 0.0:
        if gap <= 0.0:
            return 0.0
        return 2.0 * gap / (speed + sqrt(speed * speed + 2.0 * pull * gap))
    if 0.5 * speed * speed + pull * gap <= 0.0:
        return -speed / pull
    return (sqrt(max(0.0, speed * speed + 2.0 * pull * gap)) - speed) / pull


@inner_helper
def time_to_side(gap, closing, pull):
    """Return the time until a particle touches the side on which it is, or inf. `gap`: distance to the side.
    `closing`: speed of approach. `pull`: acceleration towards the side.
    """
    if pull > 0.0:
        return time_along(gap, closing, pull)
    if closing <= 0.0:
        return inf
    if pull < 0.0:
        return time_against(gap, closing, -pull)
    return max(0.0, gap / closing)


@inner_helper
def time_to_far_side(gap, closing, pull):
    """Return the time until a particle touches the opposite side of a line, or inf. The gap is negative. The
    particle must pass the line, turn and come back. `time_to_side` explains the arguments.
    """
    if closing >= 0.0 or pull <= 0.0:
        return inf
    square = closing * closing + 2.0 * pull * gap
    return (sqrt(square) - closing) / pull if square > 0.0 else inf


@inner_helper
def _polynomial(c0, c1, c2, c3, c4, t):
    return (((c4 * t + c3) * t + c2) * t + c1) * t + c0


@inner_helper
def _root_between(c0, c1, c2, c3, c4, low, high):
    """Find the root of a quartic between `low` and `high`, by Newton's method with bisection."""
    falls = _polynomial(c0, c1, c2, c3, c4, low) > 0.0
    t = 0.5 * (low + high)
    for _ in range(_HALVINGS):
        value = _polynomial(c0, c1, c2, c3, c4, t)
        if value == 0.0:
            return t
        if (value > 0.0) == falls:
            low = t
        else:
            high = t
        slope = ((4.0 * c4 * t + 3.0 * c3) * t + 2.0 * c2) * t + c1
        step = t - value / slope if slope != 0.0 else high
        if not (step > low and step < high) or abs(step - t) > 0.5 * (high - low):
            step = 0.5 * (low + high)
        if step == t or step == low or step == high:  # noqa: SIM109 - compiled
            return step
        t = step
    return t


@kernel
def time_to_contact_pulled(gap, rv, vv, ra, va, aa):
    """Return the time until two particles touch; inf if they never do. Their separation is r + v t + a t^2 /
    2; gap = r.r - sigma^2, rv = r.v, vv = v.v, ra = r.a, va = v.a, aa = a.a > 0. The result is the first time
    at which they touch or overlap and approach each other. The quartic f(t) = |r(t)|^2 - sigma^2 is examined
    between the roots of its derivative, and the derivative between the roots of the second derivative, so
    that no grazing contact is missed.
    """
    c0, c1, c2, c3, c4 = gap, 2.0 * rv, vv + ra, va, 0.25 * aa
    # f'' = 2 c2 + 6 c3 t + 12 c4 t^2 divides time into intervals in which f' is monotonic
    first = second = 0.0
    square = 9.0 * c3 * c3 - 24.0 * c4 * c2
    if square > 0.0:
        q = -3.0 * c3 - sqrt(square) if c3 > 0.0 else -3.0 * c3 + sqrt(square)
        root = q / (12.0 * c4)
        other_root = 2.0 * c2 / q if q != 0.0 else 0.0
        first, second = max(0.0, min(root, other_root)), max(0.0, max(root, other_root))
    last = max(second, sqrt(sqrt(abs(gap) / c4)), sqrt(vv / aa))
    while last < inf and not (
        _polynomial(c1, 2.0 * c2, 3.0 * c3, 4.0 * c4, 0.0, last) > 0.0
        and _polynomial(c0, c1, c2, c3, c4, last) > 0.0
    ):
        last = 2.0 * last if last > 0.0 else 1.0
    if last == inf:
        return inf
    start = 0.0
    slope = c1
    for part in range(3):
        stop = first if part == 0 else (second if part == 1 else last)
        if stop <= start and part < 2:
            continue
        end_slope = _polynomial(c1, 2.0 * c2, 3.0 * c3, 4.0 * c4, 0.0, stop)
        turn = stop
        if (slope < 0.0 and end_slope > 0.0) or (slope > 0.0 and end_slope < 0.0):
            turn = _root_between(c1, 2.0 * c2, 3.0 * c3, 4.0 * c4, 0.0, start, stop)
        # f decreases from `start` to `turn`, or from `turn` to `stop`, or not at all in this interval
        at_once = slope < 0.0 or (slope == 0.0 and end_slope < 0.0)
        if at_once or end_slope < 0.0:
            low, high = (start, turn) if at_once else (turn, stop)
            if _polynomial(c0, c1, c2, c3, c4, low) <= 0.0:
                return low
            if _polynomial(c0, c1, c2, c3, c4, high) <= 0.0:
                return _root_between(c0, c1, c2, c3, c4, low, high)
        start, slope = stop, end_slope
    return inf


@kernel
def time_of_summit(rv, vv, ra, va, aa):
    """Return the time of the largest distance between two approaches; inf for one
    (`time_to_contact_pulled`).
    """
    c1, c2, c3, c4 = 2.0 * rv, vv + ra, va, 0.25 * aa
    square = 9.0 * c3 * c3 - 24.0 * c4 * c2
    if square <= 0.0:
        return inf
    first, second = (-3.0 * c3 - sqrt(square)) / (12.0 * c4), (-3.0 * c3 + sqrt(square)) / (12.0 * c4)
    slopes = 2.0 * c2, 3.0 * c3, 4.0 * c4
    if not (
        _polynomial(c1, slopes[0], slopes[1], slopes[2], 0.0, first) > 0.0
        and _polynomial(c1, slopes[0], slopes[1], slopes[2], 0.0, second) < 0.0
    ):
        return inf
    return _root_between(c1, slopes[0], slopes[1], slopes[2], 0.0, first, second)
