"""What is collected for `make test` and `make test-all`."""


def test_collection_builds_no_simulation(pytestconfig):
    """A simulation needs a kernel at its start."""
    assert pytestconfig.kernels_of_collection == []
