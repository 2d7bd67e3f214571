"""Jobs of a run are found by their logs."""

from types import SimpleNamespace

from gaspart.reproduction import job_time
from gaspart.reproduction.archive.tables import job_times


def test_jobs_of_the_config_have_the_time_and_memory_of_their_logs(tmp_path):
    names = "report", "simulate/gas/eta=0.1", "simulate/gas/removed", "figure/failed"
    for name in names:
        log = tmp_path / f"results/logs/{name}.log"
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_text("a remark\n" if "failed" in name else f"a remark\n{job_time.describe()}\n")
    point = SimpleNamespace(experiment="gas", name="eta=0.1")
    rows = job_times(SimpleNamespace(root=tmp_path, results="results", points=[point]))
    assert [(row.rule, row.job) for row in rows] == [("report", ""), ("simulate", "gas/eta=0.1")]
    assert all(float(row.cpu_seconds) > 0.0 and float(row.largest_memory) > 1.0 for row in rows)
