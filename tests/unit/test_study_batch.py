import os
import signal

import pytest
from study_strips import BASE

from cardiosurf.config import load_text
from cardiosurf.errors import NumericalError
from cardiosurf.study import simulation
from cardiosurf.study.batch import Job, run_batch
from cardiosurf.study.job import failed, worst_exit_code
from cardiosurf.study.store import RunStore


@pytest.fixture
def job(tmp_path):
    """Return a function that makes the job of a changed strip."""
    store = RunStore(tmp_path / "runs")

    def make(name, old="step: 3", new="step: 3"):
        loaded = load_text(BASE.replace(old, new), "strip.yaml")
        return Job(name, loaded, store.folder_of(loaded))

    return make


@pytest.fixture
def marches(monkeypatch):
    """The ends of all runs that were marched in this process."""
    made, march = [], simulation.march

    def counted(problem, controls, *others, **more):
        made.append(controls.end)
        return march(problem, controls, *others, **more)

    monkeypatch.setattr(simulation, "march", counted)
    return made


def test_a_run_is_made_once_for_all_who_want_it(job, marches):
    told = []
    jobs = [job("one"), job("two", "end: 900", "end: 800"), job("twin")]
    first = run_batch(jobs, on_done=told.append)
    assert [done.name for done in first] == ["one", "two", "twin"]
    assert [done.name for done in told] == ["one", "twin", "two"]
    assert [done.reused for done in first] == [False, False, True]
    assert sorted(marches) == [800, 900]
    again = run_batch(jobs)
    assert [done.reused for done in again] == [True, True, True]
    assert sorted(marches) == [800, 900]
    for one, other in zip(first, again, strict=True):
        assert (one.verdict, one.seconds, one.meta) == (other.verdict, other.seconds, other.meta)
    assert first[0].meta["edge_length"] == 5


def test_a_run_that_fails_does_not_stop_the_others(job, marches):
    unstable = job("unstable", "step: 3", "step: 300")
    nowhere = job("nowhere", "x: [60, 80]", "x: [90, 95]")
    dones = run_batch([unstable, nowhere, job("fine")])
    assert [done.kind for done in dones] == ["numerical", "input", None]
    assert [done.verdict is None for done in dones] == [True, True, False]
    assert "strip.yaml:7: targets.far.region" in dones[1].error
    assert not unstable.folder.exists()
    assert not nowhere.folder.exists()
    assert worst_exit_code(dones) == 3


def test_a_stopped_batch_goes_on_where_it_was(job, marches, monkeypatch):
    judge = simulation.judge_recording

    def stopped(recording):
        monkeypatch.setattr(simulation, "judge_recording", judge)
        os.kill(os.getpid(), signal.SIGINT)
        return judge(recording)

    monkeypatch.setattr(simulation, "judge_recording", stopped)
    jobs = [job("one"), job("two", "end: 900", "end: 800")]
    with pytest.raises(KeyboardInterrupt):
        run_batch(jobs)
    assert (jobs[0].folder / ".partial").exists()
    assert [done.reused for done in run_batch(jobs)] == [False, False]
    # the first had only its files to write
    assert marches == [900, 800]
    assert not (jobs[0].folder / ".partial").exists()


def test_a_checkpoint_of_another_program_is_not_gone_on_with(job, marches, monkeypatch):
    judge = simulation.judge_recording

    def stopped(recording):
        raise KeyboardInterrupt

    one = job("one")
    monkeypatch.setattr(simulation, "judge_recording", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_batch([one])
    monkeypatch.setattr(simulation, "judge_recording", judge)
    record = one.folder / "run.json"
    record.write_text(record.read_text().replace('"key": "', '"key": "another'))
    (done,) = run_batch([one])
    assert done.verdict["verdict"] == "conduction"
    assert marches == [900, 900]


def test_a_checkpoint_that_cannot_be_read_costs_time_only(job, marches, monkeypatch):
    one = job("one")
    (one.folder / ".partial").mkdir(parents=True)
    (one.folder / ".partial" / "checkpoint.npz").write_bytes(b"no checkpoint")
    # as a batch leaves it that is stopped in its first run
    from cardiosurf.study.store import note_begun, run_key  # noqa: PLC0415

    note_begun(one.folder, run_key(one.loaded))
    (done,) = run_batch([one])
    assert done.kind is None
    assert marches == [900]


def test_processes_give_what_one_process_gives(job, tmp_path):
    jobs = [
        job("one"),
        job("wrong", "x: [60, 80]", "x: [90, 95]"),
        job("two", "step: 3", "step: 2"),
    ]
    told = []
    dones = run_batch(jobs, workers=2, on_done=lambda done: told.append(done.name))
    assert [done.kind for done in dones] == [None, "input", None]
    assert sorted(told) == ["one", "two", "wrong"]
    store = RunStore(tmp_path / "alone")
    alone = run_batch([Job(one.name, one.loaded, store.folder_of(one.loaded)) for one in jobs])
    assert [done.verdict for done in dones] == [done.verdict for done in alone]
    assert all(done.meta["threads"] == 1 for done in dones if done.verdict)


@pytest.mark.parametrize(
    ("error", "kind", "code"),
    [
        (NumericalError("u is not finite"), "numerical", 3),
        (MemoryError(), "numerical", 3),
        (ValueError("a mistake"), "internal", 70),
    ],
)
def test_what_a_failure_is_called(error, kind, code):
    done = failed("one", error, 1.0)
    assert (done.kind, worst_exit_code([done])) == (kind, code)
    assert done.error
