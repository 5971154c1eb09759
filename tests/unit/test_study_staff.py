"""Worker processes that stay from one batch to the next, and go when they are not needed."""

import multiprocessing

from study_strips import BASE

from cardiosurf.config import load_text
from cardiosurf.study.batch import Job, run_batch
from cardiosurf.study.store import RunStore
from cardiosurf.study.workers import Staff


def test_processes_work_for_several_batches_and_end_with_the_staff(tmp_path):
    store = RunStore(tmp_path)

    def jobs(*ends):
        loaded = [load_text(BASE.replace("900", str(end)), "strip.yaml") for end in ends]
        return [Job(str(one.config.time.end), one, store.folder_of(one)) for one in loaded]

    with Staff(2) as staff:
        first = run_batch(jobs(20, 30), workers=2, staff=staff)
        working = {process.pid for process in multiprocessing.active_children()}
        second = run_batch(jobs(30, 40, 50), workers=2, staff=staff)
        assert {process.pid for process in multiprocessing.active_children()} == working
    assert len(working) == 2
    assert multiprocessing.active_children() == []
    ends = [done.verdict["end"] for done in [*first, *second]]
    assert ends == [20.0, 30.0, 30.0, 40.0, 50.0]
    assert [done.reused for done in second] == [True, False, False]
