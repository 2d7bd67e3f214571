"""Each referee finds gaspart's files right, and an error of 3 % in them."""


def test_is_right(referee, folder, keep):
    found = keep(referee.judge(folder))
    assert found.passes, found


def test_an_error_of_three_percent_is_found(referee, folder, keep, tmp_path):
    found = keep(referee.judge(referee.plant(folder, tmp_path / "planted")), planted=True)
    assert not found.passes, (referee.error, found)
