"""Citations are followed by the number of their reference, and each has one."""

import ast
import re
from pathlib import Path

import pytest

from gaspart.reproduction.report.explore import (
    CITATION,
    Reference,
    cited_references,
    find_reference,
    read_references,
    split_citations,
)

ROOT = Path(__file__).parents[3]
REFERENCES = read_references(ROOT / "workflow/report/references.yaml")
YEAR = re.compile(r"\b(?:18|19|20)\d\d\b")
CAPTIONS = [*sorted((ROOT / "workflow/report").glob("*.rst")), ROOT / "workflow/report/sources.yaml"]
CLAIMS = sorted((ROOT / "src/gaspart/reproduction/figures").glob("[!_]*.py"))
NO_CITATION = "Kolafa's shorter\nequation of 1986"
EXAMPLES = (
    Reference(1, "Yeh 2004", ("Yeh", "Hummer"), 2004, "J. Phys. Chem. B 108, 15873", "10.1021/jp0477147"),
    Reference(2, "van Zon 1998", ("van Zon", "others"), 1998, "Phys. Rev. Lett. 80, 2035"),
    Reference(3, "Ernst 1970", ("Ernst", "Hauge", "van Leeuwen"), 1970, "Phys. Rev. Lett. 25, 1254"),
    Reference(4, "source C", ("Spencer",), 2022, "Billiards"),
)
BY_KEY = {one.key: one for one in EXAMPLES}


def strings(path):
    """The texts of a figure's module but docstrings and short names in legends, with spaces alone between
    words."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    docstrings = {node.value for node in nodes if isinstance(node, ast.Expr)}
    for node in nodes:
        if isinstance(node, ast.Constant) and len(str(node.value)) > 14 and node not in docstrings:
            yield " ".join(str(node.value).split())


TEXTS = {path.name: [path.read_text(encoding="utf-8")] for path in CAPTIONS}
TEXTS |= {f"{path.parent.name}/{path.stem}": list(strings(path)) for path in CLAIMS}


@pytest.mark.parametrize(
    ("text", "names", "numbers"),
    [
        ("[Yeh 2004], with", ["Yeh and Hummer 2004"], [1]),
        ("([van\nZon 1998]; [Ernst 1970])", ["van Zon and others 1998", "Ernst and others 1970"], [2, 3]),
        ("[Source C], Eq. 48; [source C]", ["Source C", "source C"], [4, 4]),
        ("Yeh 2004; [Hummer 2004], [0, 1]", [], []),
    ],
)
def test_a_citation_is_names_and_a_reference(text, names, numbers):
    parts = list(split_citations(text, BY_KEY))
    assert [reference.number for _, reference in parts if reference] == numbers
    assert [part for part, reference in parts if reference] == names
    assert numbers or parts == [(text, None)]


def test_only_cited_references_are_listed_and_numbered_from_1():
    kept = cited_references(["[Ernst 1970], [0, 1]", "the figure of [Source C]; [van\nZon 1998]"], BY_KEY)
    assert [(one.key, one.number) for one in kept.values()] == [
        ("van Zon 1998", 1),
        ("Ernst 1970", 2),
        ("source C", 3),
    ]
    assert cited_references(["nothing"], BY_KEY) == {}


def test_a_reference_is_listed_by_authors_place_and_year():
    assert EXAMPLES[0].text == "Yeh and Hummer, J. Phys. Chem. B 108, 15873 (2004)"
    assert EXAMPLES[3].text == "Spencer, Billiards (2022): source C"


def test_references_are_in_the_order_of_their_authors_with_valid_dois_and_their_keys():
    references = REFERENCES.values()
    names = [(*one.authors, one.year) for one in references]
    assert names == sorted(names, key=lambda name: [str(part).lower() for part in name])
    dois = [one.doi for one in references if one.doi]
    assert len(dois) == len(set(dois)) and all(re.fullmatch(r"10\.\d{4}/\S+", doi) for doi in dois)
    keys = [rf"{re.escape(one.authors[0])} {one.year}[b-z]?" for one in references]
    assert all(one.is_source or re.fullmatch(key, one.key) for one, key in zip(references, keys, strict=True))
    assert [one.key for one in references if one.is_source] == ["source A", "source B", "source C"]


def citations(text):
    """(match, reference) of each text in brackets that is a key, or ends with a year as keys do."""
    for match in CITATION.finditer(text):
        reference = find_reference(match, REFERENCES)
        if reference or YEAR.search(match[1]):
            yield match, reference


@pytest.mark.parametrize("name", TEXTS)
def test_each_year_is_in_a_citation_of_a_known_reference(name):
    unknown = []
    for text in TEXTS[name]:
        text = text.replace(NO_CITATION, "")
        known = [match.span() for match, reference in citations(text) if reference]
        unknown += [
            text[max(0, year.start() - 60) : year.end()]
            for year in YEAR.finditer(text)
            if not any(low <= year.start() < high for low, high in known)
        ]
    assert not unknown


def test_each_reference_is_cited():
    texts = [text for own in TEXTS.values() for text in own]
    known = {reference for text in texts for _, reference in citations(text)}
    assert [one.key for one in REFERENCES.values() if one not in known] == []
