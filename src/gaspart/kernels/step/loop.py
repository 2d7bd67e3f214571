"""One small step after another: the canonical step of the time-stepped engine.

A step moves all particles, reflects those that left through a wall, finds all pairs that overlap and
approach, and resolves them in the order of their contact time and indices, testing each again; further passes
find what the first has left or made. Which search finds the pairs changes no bit of the result. All
arithmetic keeps the precision of the positions (float32 or float64): hence dt - dt for 0 and x + x for 2x.
"""

from numpy import int64

from gaspart.kernels.compile.policy import allocating_kernel, inner_allocating_kernel, inner_helper
from gaspart.kernels.step.box_search import search_all, search_boxes, sort_in
from gaspart.kernels.step.model import DISPLACEMENT, FASTEST, PAIR_TESTS, Search, Step
from gaspart.kernels.step.resolve import count_left, in_order
from gaspart.kernels.step.shared_contacts import resolve_found
from gaspart.kernels.step.threads import gathered, is_outdated, make_list, move_all, room_for, search_list


@inner_helper
def total_pull(gravity):
    """The sum of the components of gravity, each counted positive."""
    pull = 0.0
    if gravity is not None:
        for component in gravity:
            pull += abs(component)
    return pull


@inner_allocating_kernel
def update_list(particles, pairs, space, tally, before, threads, cells):
    """Make the list anew if it is outdated. Returns its pairs, and `before`, see `Step`."""
    if cells is not None:
        if is_outdated(particles, cells, space, threads):
            return make_list(particles, cells, pairs, space, tally, threads), int64(0)
    return pairs, before


@inner_helper
def search_grid(particles, space, step, found, tally, boxes):
    """Search the boxes, if there are any."""
    if boxes is not None:
        sort_in(particles, boxes)
        search_boxes(particles, boxes, space, step, found, tally)


@inner_allocating_kernel
def find_contacts(particles, search, space, step, found, tally, threads):
    """Find all pairs to be resolved. Returns them in `found`, or in more room."""
    parts, count = len(found.number), particles.positions.shape[1]
    while True:
        found.number[:] = 0
        found.tests[:] = 0
        search_list(particles, search.pairs, space, step, found, threads, search.cells)
        search_grid(particles, space, step, found, tally, search.boxes)
        for slot in range(particles.ordinary, count):
            found.tests[0] += search_all(particles, slot, space, step, found)
        if found.number.max() <= found.times.shape[1]:
            break
        found = room_for(parts, 2 * found.number.max(), particles.positions)
    tally.counts[PAIR_TESTS] += found.tests.sum()
    return found


@allocating_kernel
def run_steps(particles, search, model, settings, steps, tally, threads):
    """Make so many steps; or, if none, only the list if it is outdated. settings: their length, whether
    contacts are rewound, and the number of passes at most; threads: their number, or None for one. Returns
    the pairs of the list as it stands then."""
    boxes, cells, pairs = search
    space, rules, law = model.space, model.rules, model.law
    dt, rewind, passes = settings
    parts = 1 if threads is None else threads
    found = room_for(parts, particles.positions.shape[1] // parts + 16, particles.positions)
    particles.last_pass[:] = 0
    pull = total_pull(model.gravity)
    if steps == 0:
        pairs, _ = update_list(particles, pairs, space, tally, int64(0), threads, cells)
    for n in range(steps):
        particles.bounds[FASTEST] += pull * dt
        particles.bounds[DISPLACEMENT] += particles.bounds[FASTEST] * dt
        move_all(particles, model, dt, tally, threads, rules, cells)
        number, before, first = 0, int64(0), n * passes + 1
        for now in range(first, first + passes):
            pairs, before = update_list(particles, pairs, space, tally, before, threads, cells)
            step = Step(dt, rewind, passes > 1, now, first, before)
            found = find_contacts(particles, Search(boxes, cells, pairs), space, step, found, tally, threads)
            number = found.number.sum()
            if number == 0:
                break
            contacts, times = gathered(found)
            in_turn = contacts, in_order(particles.index, contacts, times)
            resolve_found(particles, in_turn, model, step, tally, threads, law, cells)
            before = now
        if number > 0:
            count_left(particles, contacts, space, tally)
    return pairs
