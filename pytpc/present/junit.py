"""The verdict on a change as JUnit XML, which CI systems show beside the tests."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as Xml

from pytpc.base.wording import plain
from pytpc.static.budget import RULES, Finding, Verdict

_SUITE = "pytpc compare"


def junit(judged: Sequence[Verdict]) -> bytes:
    """One test case for each rule and finding.

    A finding of a broken rule fails. One of a rule that nobody asked for is skipped. A rule without
    findings, and what a budget allows, passes.
    """
    suite = Xml.Element("testsuite")
    cases = [case for verdict in judged for case in _cases(verdict)]
    suite.extend(cases)
    for element in (suite, suites := Xml.Element("testsuites")):
        element.set("name", _SUITE)
        element.set("tests", str(len(cases)))
        element.set("failures", str(_count(cases, "failure")))
        element.set("errors", "0")
        element.set("time", "0")
    suite.set("skipped", str(_count(cases, "skipped")))
    suites.append(suite)
    Xml.indent(suites)
    return bytes(Xml.tostring(suites, encoding="utf-8", xml_declaration=True)) + b"\n"


def _cases(verdict: Verdict) -> list[Xml.Element]:
    if not verdict.findings:
        return [_case(verdict, "nothing found")]
    cases = []
    for number, finding in enumerate(verdict.findings):
        case = _case(verdict, f"{finding.name} at {finding.place}")
        if verdict.is_broken and number >= verdict.most:
            failed = Xml.SubElement(case, "failure")
            failed.set("message", plain(RULES[verdict.rule]))
            failed.set("type", verdict.rule)
            failed.text = _text(finding)
        elif not verdict.is_asked:
            Xml.SubElement(case, "skipped").set("message", "the budget does not have this rule")
        cases.append(case)
    return cases


def _case(verdict: Verdict, name: str) -> Xml.Element:
    case = Xml.Element("testcase")
    case.set("classname", f"tpc.{verdict.rule}")
    case.set("name", plain(name))
    case.set("time", "0")
    return case


def _text(finding: Finding) -> str:
    return plain(f"{finding.place}: {finding.name}: {finding.text}")


def _count(cases: Sequence[Xml.Element], tag: str) -> int:
    return sum(1 for case in cases if case.find(tag) is not None)
