"""A verdict as JSON, JUnit XML and a page: all say the same, and no name of a scene becomes markup."""

from __future__ import annotations

import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from symrender.audit.evidence import evidence
from symrender.audit.judge import judged, pixel_test, region_tests, scale_test
from symrender.audit.junit import junit
from symrender.audit.measured import Measured
from symrender.audit.page import page
from symrender.audit.regions import Region
from symrender.audit.verdict import Decision, Explanation, Verdict

SHAPE = (12, 16, 3)


def verdict(factor: float, scene: str = "a scene") -> Verdict:
    rng = np.random.default_rng(2)
    truth = rng.uniform(0.2, 1.0, SHAPE)
    mean = factor * truth + 0.01 * rng.standard_normal(SHAPE)
    found = Measured(mean, np.full(SHAPE, 1e-4), 256, "moments", ("R", "G", "B"), np.eye(3), False)
    seen = evidence(found, truth, np.zeros(SHAPE[:2]), None)
    tests = judged([scale_test(seen), *region_tests(seen, [Region("all", np.ones(SHAPE[:2], bool), "")])], 0.005)
    pixels, maps = pixel_test(seen, 0.005)
    passed = all(t.outcome != "failed" for t in tests) and pixels.outcome != "failed"
    word: Decision = "passed" if passed else "failed"
    why = () if passed else (Explanation("alpha", 0.99, True, 0.1, 0.101, 4e-4, "by its exact derivative"),)
    return Verdict(
        word, 0.01, scene, "0" * 64, "moments", 256, (16, 12), tuple(tests[:1]), tuple(tests[1:]), pixels, why,
        ("a note",), 1, maps,
    )  # fmt: skip


@pytest.mark.parametrize("factor", [1.0, 1.2])
def test_every_form_says_the_same(factor: float) -> None:
    found = verdict(factor)
    assert found.passed == (factor == 1.0)
    data = json.loads(json.dumps(found.as_json(), allow_nan=False))
    assert data["passed"] == found.passed and len(data["regions"]) == 3 and data["sentence"] == found.sentence()
    suite = ElementTree.fromstring(junit(found))
    assert (
        int(suite.get("failures", ""))
        == len(suite.findall("testcase/failure"))
        == len(found.failed) + (found.pixels.outcome == "failed")
    )
    assert int(suite.get("tests", "")) == 5 == len(suite.findall("testcase"))
    text, html = found.text(), page(found)
    assert text.endswith(found.sentence()) and f'class="verdict {"passed" if found.passed else "failed"}"' in html
    assert text.index("power:") < text.index("tests:")
    if not found.passed:
        assert "consistent with truth if alpha were 0.101 +- 0.0004 instead of 0.1" in found.sentence()


def test_the_page_is_offline_and_runs_nothing() -> None:
    html = page(verdict(1.2, "<script>alert(1)</script>"))
    assert "<script" not in html and "&lt;script&gt;" in html
    assert "default-src &#x27;none&#x27;" in html
    assert not re.search(r"(?:src|href)=\"(?!data:)", html) and "url(" not in html
    assert html.count("data:image/png;base64,") == 4 and "<svg" in html


def test_a_scene_name_is_printable_in_xml() -> None:
    suite = ElementTree.fromstring(junit(verdict(1.2, "a\x1b]0;b\x07<&\"'")))
    assert "a" in suite.get("name", "")
