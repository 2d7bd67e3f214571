import numpy as np
from reproduction.claims.data import judged
from reproduction.families.tradeoff.data import speed_accuracy_measurement, time_to_accuracy_measurement

from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.tradeoff import claims as tradeoff
from gaspart.reproduction.families.tradeoff import claims as tradeoff_claims


def verdicts(dataset):
    return judged(tradeoff.speed_accuracy(dataset))


def test_orders_losses_and_frontier_agree_where_theory_holds(tmp_path):
    found = verdicts(speed_accuracy_measurement(tmp_path))
    assert set(found.values()) == {"agrees"}
    assert any("order of the error of Z" in claim and "no rewinding" in claim for claim in found)
    assert any("collisions lost to steps of 0.16" in claim for claim in found)


def test_contacts_late_by_half_a_step_are_noticed(tmp_path):
    dataset = speed_accuracy_measurement(tmp_path)
    dataset["order"] = dataset.order * 0.5
    found = verdicts(dataset)
    assert sum(verdict == "disagrees" for verdict in found.values()) == 3


def test_the_cheaper_engine_is_reported_without_a_verdict(tmp_path):
    dataset = speed_accuracy_measurement(tmp_path)
    dataset["gas_packing_fraction"] = dataset.gas_packing_fraction * 0.0 + 0.3
    found = [verdict for claim, verdict in verdicts(dataset).items() if "time of steps over" in claim]
    assert set(found) == {"no verdict"}


def test_the_cost_is_compared_with_that_of_the_finest_accuracy_that_steps_reach(tmp_path):
    dataset = speed_accuracy_measurement(tmp_path)
    dataset["gas_packing_fraction"] = dataset.gas_packing_fraction * 0.0 + 0.3
    finest, next_to = np.sort(dataset.accuracy.values)[:2]
    coarsest = dataset.accuracy.values.max()
    for absent in (np.nan, np.inf):
        dataset["best_seconds"] = dataset.best_seconds.where(dataset.accuracy > finest, absent)
        (text,) = (claim for claim in verdicts(dataset) if "time of steps for" in claim)
        assert f"for {100 * next_to:g} % of Z over that for {100 * coarsest:g} %" in text
        assert verdicts(dataset)[text] != "inconclusive"
    dataset["best_seconds"] = dataset.best_seconds.where(dataset.accuracy == coarsest)
    assert not [claim for claim in verdicts(dataset) if "time of steps for" in claim]


def choice(dataset):
    claims = tradeoff.time_to_accuracy(dataset)[-3:]
    return dict(zip(("event", "step", "choice"), judge(claims), strict=True))


def test_a_model_that_predicts_the_costs_agrees_and_one_that_does_not_is_noticed():
    assert choice(time_to_accuracy_measurement()) == dict.fromkeys(("event", "step", "choice"), "agrees")
    wrong = choice(time_to_accuracy_measurement(more_expensive=4.0))
    assert wrong == {"event": "agrees", "step": "disagrees", "choice": "disagrees"}


def of_map(dataset):
    return judged(tradeoff_claims.of_map(dataset))


def test_a_map_as_theory_has_it_agrees():
    found = of_map(time_to_accuracy_measurement())
    assert set(found.values()) == {"agrees"}
    for part in ("time of DSMC", "Enskog model in D", "heat flux", "relaxation time", "default cells"):
        assert any(part in claim for claim in found), part


def changed(name, factor, **at):
    """The measurement with one variable changed by a factor in one place."""
    dataset = time_to_accuracy_measurement()
    dataset[name].loc[at] *= factor
    return dataset


def test_costs_and_errors_that_theory_does_not_have_are_noticed():
    cases = {
        "time of DSMC over": changed("cost", 5.0, solver="boltzmann", fraction=0.001),
        "at packing fraction 0.0001 over 0.01": changed("each", 5.0, solver="boltzmann", fraction=0.0001),
        "time of a collision by the Enskog": changed("each", 0.2, solver="enskog", fraction=0.3),
        "error of the Enskog model in D": changed("error", 0.0, solver="enskog", fraction=0.3, part="model"),
        "heat flux between plates by time steps": changed("flow", 1.06, solver="step", fraction=0.1),
        "model over that by the Enskog": changed("flow", 1.04, solver="boltzmann", fraction=0.3),
        "default cells": changed("cells", 0.99, fraction=0.1),
    }
    for part, dataset in cases.items():
        wrong = [claim for claim, verdict in of_map(dataset).items() if verdict == "disagrees"]
        assert any(part in claim for claim in wrong), part
