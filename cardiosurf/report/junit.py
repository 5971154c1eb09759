"""What a check found, as the JUnit XML that CI servers read."""

import re
from xml.etree import ElementTree as ET

from cardiosurf.report.check_report import difference_lines
from cardiosurf.study.check import CaseResult, CheckResult
from cardiosurf.study.pairs import PairResult

_FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML cannot hold, not even escaped."""


def junit_xml(result: CheckResult) -> str:
    """Return a check as JUnit XML: a suite for each scenario, a test for each case and pair.

    Parameters
    ----------
    result : CheckResult
        The check.
    """
    root = ET.Element("testsuites", name="cardiosurf check")
    for scenario in dict.fromkeys(case.scenario for case in result.cases):
        suite = ET.SubElement(root, "testsuite", name=_clean(scenario))
        cases = [case for case in result.cases if case.scenario == scenario]
        for case in cases:
            _add_case(suite, case)
        for pair in result.pairs:
            if pair.scenario == scenario:
                _add_pair(suite, pair)
        _count(suite, sum(case.done.seconds for case in cases))
    _count(root, sum(case.done.seconds for case in result.cases))
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _add_case(suite: ET.Element, case: CaseResult) -> None:
    test = _test(suite, case.scenario, case.case, case.done.seconds)
    if case.status == "agrees":
        return
    lines = [_clean(line) for line in difference_lines(case)]
    kind = "failure" if case.status == "differs" else "error"
    cause = "verdict" if case.status == "differs" else str(case.done.kind)
    found = ET.SubElement(test, kind, message=lines[0], type=cause)
    found.text = "\n".join(lines)


def _add_pair(suite: ET.Element, pair: PairResult) -> None:
    test = _test(suite, pair.scenario, pair.name, 0.0)
    if not pair.agrees:
        message = f"expected {pair.expected}, found {pair.verdict or 'nothing: a run failed'}"
        ET.SubElement(test, "failure", message=message, type="pair")


def _test(suite: ET.Element, scenario: str, name: str, seconds: float) -> ET.Element:
    attributes = {"classname": _clean(scenario), "name": _clean(name), "time": f"{seconds:.3f}"}
    return ET.SubElement(suite, "testcase", attributes)


def _count(element: ET.Element, seconds: float) -> None:
    """Note how many tests there are below an element, and how many failed."""
    counts = {"tests": "testcase", "failures": "failure", "errors": "error"}
    for attribute, tag in counts.items():
        element.set(attribute, str(sum(1 for _ in element.iter(tag))))
    element.set("time", f"{seconds:.3f}")


def _clean(text: str) -> str:
    return _FORBIDDEN.sub("?", text)
