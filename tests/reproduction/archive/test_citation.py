"""Title, creators and licence of an archive."""

import pytest

from gaspart.errors import SceneError
from gaspart.reproduction.archive.metadata import read_citation

TEXT = """
title: a gas
version: 1.2
license: BSD-3-Clause
repository-code: https://example.org/gas
authors:
  - {given-names: Ludwig, family-names: Boltzmann, orcid: "https://orcid.org/0000", affiliation: Wien}
  - {name: the others, website: https://example.org}
"""


def test_persons_and_organisations_are_read(tmp_path):
    (tmp_path / "CITATION.cff").write_text(TEXT)
    found = read_citation(tmp_path / "CITATION.cff")
    person = {"@id": "https://orcid.org/0000", "@type": "Person", "name": "Ludwig Boltzmann"}
    organization = {"@id": "https://example.org", "@type": "Organization", "name": "the others"}
    assert found.creators == [person | {"affiliation": "Wien"}, organization]
    assert found[0] == "a gas" and found.licence == "BSD-3-Clause"
    assert found.url == "https://example.org/gas" and found.keywords == []


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("license: BSD-3-Clause", "", "license = None: is required for an archive"),
        (TEXT[TEXT.index("authors") :], "authors: Boltzmann", "authors = 'Boltzmann': must be a list"),
    ],
)
def test_what_is_missing_is_named(tmp_path, old, new, line):
    (tmp_path / "CITATION.cff").write_text(TEXT.replace(old, new))
    with pytest.raises(SceneError) as error:
        read_citation(tmp_path / "CITATION.cff")
    assert f"CITATION.cff: {line}" in str(error.value)
