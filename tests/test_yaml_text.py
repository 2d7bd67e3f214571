"""The reader of YAML: what it gives, and that whatever it refuses is one short line, at once."""

import pytest
import yaml
from hypothesis import given
from malformed import mutated_texts, one_line, texts

from gaspart.errors import SceneError
from gaspart.yaml_text import DEEPEST, dump_yaml, parse_yaml, read_yaml, write_yaml

CHAIN = "".join(f"a{n}: &a{n} {40 * '['}*a{n - 1}{40 * ']'}\n" for n in range(1, 9)).replace("*a0", "1")
BOMB = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"a{n}: &a{n} [{', '.join(9 * [f'*a{n - 1}'])}]\n" for n in range(1, 9)
)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e3", 1e3),
        ("-1.5e3", -1.5e3),
        ("1_000", 1000),
        ("0x10", 16),
        (".inf", float("inf")),
        ("'1e3'", "1e3"),
        ("2001-02-30", "2001-02-30"),
        ("", None),
        ("yes", True),
        ("{a: &x [1, 2], b: *x}", {"a": [1, 2], "b": [1, 2]}),
        ("{a: &x {p: 1, q: 2}, b: {<<: *x, q: 3}}", {"a": {"p": 1, "q": 2}, "b": {"p": 1, "q": 3}}),
        ("{<<: [{p: 1}, {p: 2, q: 2}]}", {"q": 2, "p": 1}),
        ("{'<<': 1}", {"<<": 1}),
    ],
)  # fmt: skip
def test_values_are_those_that_a_user_expects(text, value):
    read = parse_yaml(text)
    assert read == value
    assert type(read) is type(value)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("a: !!int abc", "x.yaml: line 1, column 4 = 'tag:yaml.org,2002:int': tags are not supported"),
        ("a: !!python/object/apply:os.system [ls]", "tags are not supported"),
        ("a: 0x_", "x.yaml: line 1, column 4 = '0x_': is not a number that can be read"),
        ("a: " + 5000 * "9", "has too many digits"),
        ("a: " + 400 * "59:" + "59.5", "is not a number that can be read|has too many digits"),
        (3000 * "[" + 3000 * "]", f"column {DEEPEST + 2} = {DEEPEST + 1}: values may be nested"),
        (100_000 * "{a: ", "values may be nested"),
        (100_000 * "- ", "values may be nested"),
        (BOMB, "aliases may give 100000 values"),
        ("a: &a [*a]", "x.yaml: line 1, column 8 = '.a': no value above has this name"),
        (CHAIN, "values may be nested"),
        ("a: *b", r"line 1, column 4 = '\*b': no value above has this name"),
        ("mass: 1\nm: 2\nmass: 3", "line 3, column 1 = 'mass': is a duplicate key, first in line 1"),
        ("a: {<<: {p: 1}, <<: {q: 1}}", "<< must be given once"),
        ("3: a", "line 1, column 1 = 3: a key must be text"),
        ("{~: 1}", "a key must be text: write it in quotes"),
        ("{a: 0,5, b: 1}", "column 7 = 5: a key must be text: a decimal has a point, not a comma"),
        ("{a: (1, 2), b: 1}", r"column 9 = '2\)': ends a list, which is written in square brackets"),
        ("a: [1\n", "x.yaml: line 2, column 1 = 'the end': is not valid YAML: did not find"),
        ("a: 1\n b: 2", "x.yaml: line 2, column 3 = 'b: 2': is not valid YAML"),
        ("--- 1\n--- 2", "line 2, column 1 = '---': begins a second document"),
        ("a: \0", "is not valid YAML"),
        ("a: '" + "\x07" * 3 + "'", "is not valid YAML"),
        (65 * 2**20 * "a", "must not be longer than 64 MiB"),
    ],
)  # fmt: skip
def test_what_is_refused_is_one_short_line_at_once(text, line):
    assert not one_line(parse_yaml, text, "x.yaml")
    with pytest.raises(SceneError, match=line) as refused:
        parse_yaml(text, "x.yaml")
    assert len(str(refused.value)) < 400


@pytest.mark.parametrize("path", ["nowhere.yaml", ".", "\0", None, 3, "/dev/zero"])
def test_a_path_that_cannot_be_read_is_one_line(path):
    with pytest.raises(SceneError):
        read_yaml(path)


def test_a_text_that_is_none_is_refused(tmp_path):
    (tmp_path / "a.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(SceneError, match="cannot be read"):
        read_yaml(tmp_path / "a.yaml")
    for text in (None, 3, b"a: 1"):
        with pytest.raises(SceneError, match="must be text"):
            parse_yaml(text)


def test_the_number_of_values_is_limited(monkeypatch):
    monkeypatch.setattr("gaspart.yaml_text.MOST_VALUES", 100)
    assert parse_yaml(f"[{99 * '1,'}]") == 99 * [1]
    with pytest.raises(SceneError, match="column 200 = 101: there may be 100 values"):
        parse_yaml(f"[{100 * '1,'}]")


def test_an_alias_is_a_copy():
    read = parse_yaml("{a: &x {p: [1]}, b: *x}")
    read["a"]["p"].append(2)
    assert read["b"] == {"p": [1]}


def test_what_is_written_is_read_again(tmp_path):
    content = {
        "words": ["1e3", "2001-02-03", "yes", "=", "<<", "ü\n"],
        "numbers": [1e300, 1e-5, 3, -0.5, True, None],
    }
    assert parse_yaml(dump_yaml(content)) == content
    write_yaml(tmp_path / "a.yaml", content)
    assert read_yaml(tmp_path / "a.yaml") == content


@given(texts())
def test_it_agrees_with_pyyaml_on_plain_text(text):
    assert parse_yaml(text) == yaml.safe_load(text)


@given(mutated_texts())
def test_any_text_is_read_or_refused_in_one_line(text):
    one_line(parse_yaml, text, "x.yaml")
