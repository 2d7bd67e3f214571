"""Figures that a config states by itself, from the config to the picture."""

import copy
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reproduction.figures.drawn import draw, lines, shows

import gaspart as gp
from gaspart.analysis import measuring
from gaspart.analysis.observable import observable as made
from gaspart.analysis.observables import OBSERVABLES, observables_with
from gaspart.errors import SceneError
from gaspart.reproduction.claims import judge
from gaspart.reproduction.config import check
from gaspart.reproduction.figures import own
from gaspart.reproduction.figures.own import APPROXIMATE
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.points import figure_points

GAS = {"dimension": 3, "count": 60, "radius": 0.5, "boundary": "periodic", "temperature": 1.0}
SETTINGS = {
    "kind": "observable", "observable": "Z", "against": "packing_fraction", "experiments": ["gas"],
    "caption": "Spheres in a periodic cube.",
    "claims": [
        {"that": "theory", "required": 0.05, "fails_if": "collisions are missed"},
        {"that": "at_least", "value": 1.0, "required": 0.05, "source": "repulsion", "fails_if": "Z is less"},
        {
            "that": "value", "between": [0.1, 0.1], "value": 2.5, "tolerance": 0.3,
            "source": "a wrong one", "fails_if": "Z is not 2.5",
        },
    ],
}  # fmt: skip
POWER = {"that": "exponent", "value": 1.0, "tolerance": 0.1, "source": "a", "fails_if": "b"}
CONFIG = {
    "title": "a user's own",
    "seed": 1,
    "points": "results/points",
    "experiments": {
        "gas": {
            "point": {**GAS, "duration": 30.0, "samples": 64, "equilibration": 5, "replicas": 2},
            "grid": {"packing_fraction": [0.05, 0.1]},
        },
        "placed": {"job": "fill", "point": {**GAS, "packing_fraction": 0.1, "attempts": 100}},
    },
    "figures": {"my_gas": SETTINGS},
}


def observable(dataset, stated):
    return list(own.claims(dataset, stated))


def changed(**settings):
    config = copy.deepcopy(CONFIG)
    config["figures"]["my_gas"] = {**SETTINGS, **settings}
    return config


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    """The points of the config, simulated."""
    planned = check(CONFIG)
    folder = tmp_path_factory.mktemp("own")
    points = [replace(point, root=str(folder)) for point in figure_points(CONFIG, "my_gas", planned)]
    for point in points:
        simulate(Path(point.path), **point.arguments)
    return points


def measured(points, **settings):
    settings = {**SETTINGS, **settings}
    dataset = own.measure(points, settings)
    return dataset.assign_attrs(settings=json.dumps(settings))


def test_a_number_is_that_of_the_analysis_with_the_theory(simulated):
    dataset = measured(simulated)
    assert dataset["against"].values.tolist() == [0.05, 0.1]
    start = simulated[0].schedule.equilibration
    replicas = [gp.analysis.compressibility_factor(path, start=start) for path in simulated[0].replica_paths]
    assert float(dataset["value"][0]) == pytest.approx(np.mean([float(one.estimate) for one in replicas]))
    errors = [float(one.error) for one in replicas]
    assert float(dataset["value_error"][0]) == pytest.approx(np.hypot(*errors) / 2)
    assert float(dataset["theory"][0]) == pytest.approx(float(replicas[0].theory))
    assert 0.0 < float(dataset["value_freedom"][0]) < np.inf


def test_claims_are_those_of_the_config(simulated):
    claims = observable(measured(simulated), SETTINGS["claims"])
    assert [claim.claim for claim in claims] == [
        "Z compared with theory at packing_fraction 0.05",
        "Z compared with theory at packing_fraction 0.1",
        "Z at packing_fraction 0.05 (at least 1)",
        "Z at packing_fraction 0.1 (at least 1)",
        "Z at packing_fraction 0.1 (within 2.2 to 2.8)",
    ]
    assert judge(claims) == ["agrees"] * 4 + ["disagrees"]


def test_an_exponent_and_a_theory_of_unknown_uncertainty():
    x = np.array([1.0, 2.0, 4.0, 8.0])
    rows = [
        {"against": at, "series": "", "value": at**0.5, "value_error": 0.01, "value_freedom": np.inf}
        | {"theory": at**0.5, "theory_error": np.nan}
        for at in x
    ]
    dataset = own.from_rows("point", rows).assign_attrs(observable="D", against="count", source="Enskog")
    power = {"that": "exponent", "tolerance": 0.05, "source": "free flight", "fails_if": "it is not"}
    verdicts = {value: judge(observable(dataset, [{**power, "value": value}])) for value in (0.5, 1.0)}
    assert verdicts == {0.5: ["agrees"], 1.0: ["disagrees"]}
    few = observable(dataset, [{**power, "value": 0.5, "between": [1, 2]}])
    assert judge(few) == ["inconclusive"]
    theory = {"that": "theory", "required": 0.1, "fails_if": "it is not"}
    assert {claim.no_verdict for claim in observable(dataset, [theory])} == {APPROXIMATE}
    assert judge(observable(dataset, [{**theory, "tolerance": 0.2}])) == ["agrees"] * 4


def test_numbers_are_drawn_with_theory(simulated):
    dataset = measured(simulated)
    (axis,) = draw(own.draw, dataset).axes
    shows(axis, dataset["against"], dataset["value"], dataset["value_error"])
    assert np.allclose(lines(axis)[0].get_ydata(), dataset["theory"])
    (plain,) = draw(own.draw, measured(simulated, theory=False, logarithmic="both")).axes
    assert not lines(plain)
    assert plain.get_xscale() == plain.get_yscale() == "log"


def test_a_curve_is_drawn_for_each_point_and_may_be_taken_at_one_place(simulated):
    dataset = measured(simulated, observable="rdf")
    assert dataset["value"].dims == ("point", "along")
    (axis,) = draw(own.draw, dataset).axes
    drawn = lines(axis)[2]  # after the first curve and its theory
    assert np.array_equal(drawn.get_ydata(), dataset["value"][1], equal_nan=True)
    contact = measured(simulated, observable="rdf", place=1.0)
    nearest = np.nanargmin(np.abs(dataset["along_places"].values - 1.0), axis=1)
    assert np.allclose(contact["value"], dataset["value"].values[[0, 1], nearest])


def test_the_names_of_the_curves_are_known(simulated):
    (path, *_) = simulated[0].replica_paths
    curves = set()
    with gp.open_trajectory(path) as trajectory:
        for name in OBSERVABLES:
            try:
                found = measuring.measure(trajectory, name)
            except SceneError:  # needs another run
                continue
            if any(found[dim].dtype.kind in "fiu" for dim in found.estimate.dims):
                curves.add(name)
    assert {"rdf", "speeds"} <= curves <= set(observables_with(form="curve")) <= set(OBSERVABLES)


def test_an_observable_with_names_has_a_series_for_each(simulated, monkeypatch):
    faces = {"face": (np.array(["y high", "y low"]), {})}
    values, errors = np.array([1.0, 2.0]), np.array([0.1, 0.2])
    one = made("pressure", faces, values, errors, units="1", long_name="pressure", theory=(1.5, np.nan))
    monkeypatch.setattr(own, "measure_point", lambda *_, **__: ({"pressure": [one, one]}, 1.0, {}))
    dataset = measured(simulated, observable="pressure")
    assert dataset["series"].values.tolist() == ["y high"] * 2 + ["y low"] * 2
    assert dataset["value"].values.tolist() == [1.0, 1.0, 2.0, 2.0]
    claims = observable(dataset, [{**SETTINGS["claims"][1], "between": [0.1, 0.1]}])
    assert [claim.claim for claim in claims] == [
        f"pressure at packing_fraction 0.1, {face} (at least 1)" for face in ("y high", "y low")
    ]


@pytest.mark.parametrize(
    ("settings", "key", "rule"),
    [
        ({"against": "mass"}, "against", "a number at every point"),
        ({"experiments": ["placed"]}, "experiments", "must make trajectories"),
        ({"observable": "z"}, "observable", "must be one of"),
        ({"place": 1.0}, "place", "for a curve only"),
        ({"observable": "rdf"}, "claims.0", "needs the place"),
        (
            {"claims": [{"that": "theory", "required": 0.1, "value": 1.0, "fails_if": "a"}]},
            "claims.0.value",
            "has no meaning",
        ),
        (
            {"claims": [{**SETTINGS["claims"][2], "between": [0.2, 0.4]}]},
            "claims.0.between",
            "there is none of the points, which are from 0.05 to 0.1",
        ),
        ({"claims": [POWER]}, "claims.0", "needs 3 points or more; there are 2"),
        ({"observable": "shear_viscosity"}, "observable", "needs correlations of the stress"),
        ({"observable": "pair_rates", "claims": []}, "observable", "must count collisions by pairs"),
    ],
)
def test_a_mistake_is_one_line_before_any_job(settings, key, rule):
    with pytest.raises(SceneError) as refused:
        check(changed(**settings))
    assert refused.value.key == f"figures.my_gas.{key}"
    assert rule in refused.value.rule


def test_a_name_of_the_package_is_not_one_of_ones_own():
    with pytest.raises(SceneError, match="needs another name"):
        check({**CONFIG, "figures": {"virial_discs": SETTINGS}})
    with pytest.raises(SceneError, match="kind: observable"):
        check({**CONFIG, "figures": {"my_gas": {"experiments": ["gas"]}}})
    check({**CONFIG, "figures": {}})


MODULE = """
from gaspart.keys import count
from gaspart.reproduction.figure import Parts

FIGURES = {"mine": Parts({"order": count("the order", default=2)}, None, None, None)}
"""


def test_a_figure_may_have_a_module_beside_the_config(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(MODULE)
    (tmp_path / "broken.py").write_text("1 / 0")

    def checked(**settings):
        figures = {"mine": {"module": "mine.py", "experiments": ["gas"], **settings}}
        return check({**copy.deepcopy(CONFIG), "figures": figures})

    assert len(checked(order=3, caption="**Mine.** Text")["gas"]) == 2
    for settings, complaint in (
        ({"order": 0}, "figures.mine.order = 0: must be"),
        ({"width": 1}, "figures.mine.width = 1: unknown key"),
        ({"caption": "{{Z"}, "figures.mine.caption = .*: {{ is not closed"),
        ({"module": "../mine.py"}, "figures.mine.module = '../mine.py': must"),
        ({"module": "absent.py"}, "figures.mine.module = 'absent.py': must have .* FileNotFoundError"),
        ({"module": "broken.py"}, "figures.mine.module = 'broken.py': must have .* ZeroDivisionError"),
    ):
        with pytest.raises(SceneError, match=complaint):
            checked(**settings)


def test_a_viscosity_needs_frames_of_a_run_with_correlations_of_the_stress(tmp_path):
    """Its point is measured as `gaspart.sweep` would; without `frames` the file has two, and no error."""
    config = copy.deepcopy(CONFIG)
    config["figures"]["my_gas"] = {**SETTINGS, "observable": "shear_viscosity", "claims": []}
    point = config["experiments"]["gas"]["point"]
    point |= {"samples": 640, "equilibration": 3, "lags": 20, "stress": True, "replicas": 1}
    with pytest.raises(SceneError, match=r"my_gas.observable = 'shear_viscosity': .*: frames: .*keep more"):
        check(config)
    for frames, rule in ((60, "divisor of samples"), (1000, "divisor of samples")):
        point["frames"] = frames
        with pytest.raises(SceneError, match=rf"gas.frames = {frames}: must be a {rule}"):
            check(config)
    point["frames"] = 64
    (one, _) = figure_points(config, "my_gas", check(config))
    assert one.schedule.equilibration_frames == 70  # whole intervals between frames, of 10 samples
    one = replace(one, root=str(tmp_path))
    simulate(Path(one.path), **one.arguments)
    found = measured([one], observable="shear_viscosity")
    direct = gp.analysis.shear_viscosity(one.replica_path(0), start=one.schedule.equilibration)
    assert float(found["value"][0]) == float(direct.estimate) and found["value_error"][0] > 0.0
    with gp.open_trajectory(one.replica_path(0)) as trajectory:
        assert trajectory.sizes["frame"] == 72 and trajectory["correlated_samples"][-1] == 640
