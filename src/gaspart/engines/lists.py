"""Which bodies are in which box: a linked list a box, through the bodies' plans."""

from gaspart.kernel import helper, kernel


@helper
def box_of(plans, partition, body):
    """The linear index of the body's box."""
    at = plans[body].at
    return at[0] * partition.strides[0] + at[1] * partition.strides[1] + at[2] * partition.strides[2]


@helper
def put(plans, partition, body):
    """Put a body at the head of its box's list."""
    box = box_of(plans, partition, body)
    first = partition.head[box]
    plans[body].box_after = first
    plans[body].box_before = -1
    if first >= 0:
        plans[first].box_before = body
    partition.head[box] = body


@helper
def take(plans, partition, body):
    """Take a body out of its box's list."""
    before = plans[body].box_before
    after = plans[body].box_after
    if before >= 0:
        plans[before].box_after = after
    else:
        partition.head[box_of(plans, partition, body)] = after
    if after >= 0:
        plans[after].box_before = before


@kernel
def sort_in(plans, partition):
    """Put all bodies into the lists of their boxes."""
    partition.head[:] = -1
    for body in range(len(plans)):
        put(plans, partition, body)
