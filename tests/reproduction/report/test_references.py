"""Citations are followed by the number of their reference, and each has one."""

import ast
import re
from pathlib import Path

import pytest

from gaspart.reproduction.report.references import Reference, linked, read_references

ROOT = Path(__file__).parents[3]
REFERENCES = read_references(ROOT / "workflow/report/references.yaml")
YEAR = re.compile(r"\b(?:18|19|20)\d\d\b")
CAPTIONS = sorted(path for path in (ROOT / "workflow/report").glob("*.rst"))
CLAIMS = sorted((ROOT / "src/gaspart/reproduction/families").glob("*/claims.py"))
NO_CITATION = "Kolafa's shorter\nequation of 1986"
ONE = Reference(1, ("Yeh", "Hummer"), 2004, "J. Phys. Chem. B 108, 15873", "10.1021/jp0477147")
TWO = Reference(2, ("Kolafa", "Labík"), 2004, "Phys. Chem. Chem. Phys. 6, 2335")
THREE = Reference(3, ("Engel", "others"), 2013, "Phys. Rev. E 87, 042134")
SOURCE = Reference(4, ("Spencer",), 2022, "Billiards", called="source C")


def strings(path):
    """The texts of a module of claims, with spaces alone between words."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield " ".join(node.value.split())


TEXTS = {path.name: [path.read_text(encoding="utf-8")] for path in CAPTIONS}
TEXTS |= {path.parent.name: list(strings(path)) for path in CLAIMS}


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("Yeh &amp; Hummer, J. Phys. Chem. B 108, 15873 (2004), with", [1]),
        ("of Yeh and Hummer (2004) and of\nKolafa and\nLabik 2004", [1, 2]),
        ("Engel and others 2013; Spencer 2022, section 4", [3, 4]),
        ("Source C, Eq. 48; source C and Spencer 2022", [4]),
        ("Hummer 2004, Yeh and Hummer 2005; 2013", []),
    ],
)
def test_the_first_citation_of_each_reference_is_followed_by_its_number(text, numbers):
    made = linked(text, [ONE, TWO, THREE, SOURCE])
    assert [int(number) for number in re.findall(r'href="#reference-(\d+)"', made)] == numbers
    assert re.sub(r"\N{NO-BREAK SPACE}<a .*?</a>", "", made) == text


def test_a_reference_is_listed_by_authors_place_and_year():
    assert ONE.text == "Yeh and Hummer, J. Phys. Chem. B 108, 15873 (2004)"
    assert SOURCE.text == "Spencer, Billiards (2022): source C"


def test_references_are_in_the_order_of_their_authors_with_valid_dois():
    names = [(*one.authors, one.year) for one in REFERENCES]
    assert names == sorted(names, key=lambda name: [str(part).lower() for part in name])
    dois = [one.doi for one in REFERENCES if one.doi]
    assert len(dois) == len(set(dois)) and all(re.fullmatch(r"10\.\d{4}/\S+", doi) for doi in dois)


@pytest.mark.parametrize("name", TEXTS)
def test_each_cited_year_belongs_to_a_reference(name):
    unknown = []
    for text in TEXTS[name]:
        text = text.replace(NO_CITATION, "")
        known = [match.span() for one in REFERENCES for match in one.pattern.finditer(text)]
        unknown += [
            text[max(0, year.start() - 60) : year.end()]
            for year in YEAR.finditer(text)
            if not any(low <= year.start() < high for low, high in known)
        ]
    assert not unknown


def test_each_reference_is_cited():
    texts = "\n;".join(text for own in TEXTS.values() for text in own)
    assert not [one.text for one in REFERENCES if not one.pattern.search(texts)]
