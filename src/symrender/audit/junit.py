"""A verdict as JUnit XML, which build servers show: a test case a test."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement, tostring

from symrender.audit.verdict import Verdict
from symrender.scene.printable import printable


def junit(verdict: Verdict) -> bytes:
    """The XML document."""
    pixel = verdict.pixels
    outcomes = [(f"{t.name} {t.region} {t.channel}", t.outcome, t.why, _words(t.z, t.adjusted)) for t in verdict.tests]
    outcomes += [
        (f"{t.name} {t.region} {t.channel}", t.outcome, t.why, _words(t.z, t.adjusted)) for t in verdict.regions
    ]
    outcomes.append(("pixels", pixel.outcome, pixel.why, f"{pixel.rejected} of {pixel.judged} rejected"))
    outcomes += [("undecided", "not judged", why, "") for why in verdict.undecided]
    suite = Element(
        "testsuite",
        name=f"symrender audit of {printable(verdict.scene)}",
        tests=str(len(outcomes)),
        failures=str(sum(outcome == "failed" for _, outcome, _, _ in outcomes)),
        skipped=str(sum(outcome == "not judged" for _, outcome, _, _ in outcomes)),
    )
    for name, outcome, why, words in outcomes:
        case = SubElement(suite, "testcase", classname="symrender.audit", name=printable(name))
        if outcome == "failed":
            SubElement(case, "failure", message=words).text = verdict.sentence()
        elif outcome == "not judged":
            SubElement(case, "skipped", message=why)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(suite)


def _words(z: float, p: float) -> str:
    return f"z {z:+.2f}, adjusted p {p:.2g}"
