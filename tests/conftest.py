"""How hypothesis draws: the same scenes every time here, new ones with `--hypothesis-profile=search`."""

from hypothesis import settings

settings.register_profile("fixed", max_examples=50, derandomize=True, deadline=None)
settings.register_profile("search", max_examples=1000, deadline=None)
settings.load_profile("fixed")
