"""Every case of every scenario must still end as it is written there, at full and fast meshes."""

from pathlib import Path

import pytest

from cardiosurf.config.scenario_file import read_scenario, scenario_paths
from cardiosurf.report.check_report import check_lines
from cardiosurf.study.check import How, check

FILES = scenario_paths([Path(__file__).parents[2] / "scenarios"])
WITH_CASES = [path for path in FILES if read_scenario(path).scenario.cases]


@pytest.mark.slow
@pytest.mark.parametrize("fast", [False, True], ids=["full", "fast"])
@pytest.mark.parametrize("path", WITH_CASES, ids=[path.stem for path in WITH_CASES])
def test_everything_is_as_expected(path, fast, tmp_path):
    result = check([read_scenario(path)], tmp_path, how=How(fast=fast))
    assert result.exit_code == 0, "\n".join(check_lines(result))


@pytest.mark.parametrize("path", FILES, ids=[path.stem for path in FILES])
def test_every_case_and_point_has_a_config_that_is_right(path):
    file = read_scenario(path)
    cases = file.cases(fast=True)
    assert len(cases) == len(file.scenario.cases)
    # a case that expects nothing is compared with nothing
    assert all(case.expected for case in cases)
    assert cases or file.points()
