"""Prose: no measured digit is typed, holes are filled or fail by name, figures are shown as their forms say."""

from __future__ import annotations

import re

import pytest

from symrender.chapter.document import prose
from symrender.chapter.document.figures import Figure, Measured, merged, shown
from symrender.chapter.document.page import SECTIONS, prose_text, read_references
from symrender.chapter.document.prose import CITATION, HOLDS, HOLE, MATH, Source, plain_markdown, to_html
from symrender.errors import OptionError

NAMES = ("opening", *SECTIONS)
MEASURED = Measured({"a.small": Figure(-1.234567e-5, "a source"), "a.count": Figure(4096, "")}, {"pic": "<img>"})
IN_MATH = re.compile(r"(?<![\d.])\d{1,2}(?!\d|\.\d)")
"""A whole number of one or two digits is all that a formula may hold."""


def html(text: str, measured: Measured = MEASURED) -> str:
    return to_html(Source("some.md", text, measured, read_references()))


def typed_digits(text: str) -> list[str]:
    """Runs of digits a reader would see that are no figures and no parts of formulas, headings, names or addresses."""
    text = HOLDS.sub("", HOLE.sub("", text))
    for math in MATH.finditer(text):
        text = text.replace(math[0], " " + re.sub(r"log1p|expm1", "", IN_MATH.sub("", math[0])) + " ")
    text = CITATION.sub("", text)
    text = re.sub(r"^(#+ .*|@(figure|block) .*)$", "", text, flags=re.MULTILINE)
    text = re.sub(r"<[^>]*>|\]\([^)]*\)|`chapter8`", " ", text)
    return re.findall(r"\S*\d\S*", text)


@pytest.mark.parametrize("name", NAMES)
def test_no_measured_digit_is_typed(name: str) -> None:
    text = prose_text(name)
    assert len(text) > 300
    assert typed_digits(text) == []


@pytest.mark.parametrize(
    "text", ["off by 73 %", "it is .0073 there", "$x = 0.5$", "$x = 4096$", "4,096 pixels", "in `16` rings", "K=8"]
)
def test_a_typed_digit_is_seen(text: str) -> None:
    assert typed_digits(text)


def test_prose_holds_figures_at_all() -> None:
    holes = [hole[1] for name in NAMES for hole in HOLE.finditer(prose_text(name))]
    assert len(holes) > 120
    assert len(set(holes)) > 90
    assert len([claim for name in NAMES for claim in HOLDS.findall(prose_text(name))]) > 20


def test_holes_are_filled_with_all_their_digits_beside_them() -> None:
    made = html("It is @{a.small} and $x = @{a.small:2g}$, of @{a.count:count}.")
    assert "−1.23\N{NARROW NO-BREAK SPACE}×\N{NARROW NO-BREAK SPACE}10<sup>−5</sup>" in made
    assert 'value="-1.234567e-05" title="a.small = -1.234567e-05; a source"' in made
    assert "<mn>1.2</mn>" in made
    assert "4\N{NARROW NO-BREAK SPACE}096" in made


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("of @{a.nothing} pixels", "some.md: no figure is called 'a.nothing'"),
        ("$x = @{a.nothing}$", "some.md: no figure is called 'a.nothing'"),
        ("of @{a.small:furlongs}", "some.md: figure 'a.small': no form 'furlongs'"),
        ("@figure nothing\nA caption.", "some.md: no block is called 'nothing'"),
        ("@block nothing", "some.md: no block is called 'nothing'"),
        ("as [@nobody1900] says", "some.md: no reference is called 'nobody1900'"),
        ("@holds a.count < a.small", "@holds a.count < a.small: measured 4096 < -1.23457e-05"),
        ("@holds a.nothing < 3", "no figure is called 'a.nothing'"),
    ],
)
def test_what_is_not_there_fails_by_name(text: str, told: str) -> None:
    with pytest.raises(OptionError, match=re.escape(told)):
        html(text)


def test_a_claim_that_holds_leaves_nothing_on_the_page() -> None:
    assert html("Before.\n\n@holds -1 < a.small < a.count\n\nAfter.") == html("Before.\n\n\nAfter.")


def test_figures_pictures_and_markdown_live_together() -> None:
    made = html('# no\n\n@figure pic wide\nA *caption* with @{a.count}.\n\n<div class="aside">\n\nHi **you**\n\n</div>')
    assert '<figure id="fig-pic" class="wide"><img><figcaption>A <em>caption</em> with <data' in made
    assert '<div class="aside">\n<p>Hi <strong>you</strong></p>\n</div>' in made


@pytest.mark.parametrize(
    ("value", "form", "text"),
    [
        (0.0, "", "0"),
        (0.5, "", "0.5"),
        (0.123456, "", "0.123"),
        (1234.4, "", "1230"),
        (999999.0, "3g", "1.00 × 10<sup>6</sup>"),
        (12, "", "12"),
        (-0.99949, ".3f", "−0.999"),
        (0.7335, "signed", "+73.4 %"),
        (-0.7335, "signed", "−73.4 %"),
        (1 / 3, "percent", "33.3 %"),
        (3.141592653589793 / 3, "degrees", "60.0 °"),
        (1e-7, "", "1 × 10<sup>−7</sup>"),
        ("<b>", "", "&lt;b&gt;"),
    ],
)
def test_forms(value: float | int | str, form: str, text: str) -> None:
    assert shown(value, form).replace("\N{NARROW NO-BREAK SPACE}", " ") == text


@pytest.mark.parametrize(("value", "form"), [(float("nan"), ""), (float("inf"), "2g"), ("word", "2g"), (1.0, "wide")])
def test_what_cannot_be_shown_is_refused(value: float | str, form: str) -> None:
    with pytest.raises(ValueError):
        shown(value, form)


def test_a_name_measured_twice_is_refused() -> None:
    with pytest.raises(ValueError, match=r"a\.count"):
        merged([MEASURED, Measured({"a.count": Figure(1, "")})])


def test_every_reference_is_cited_and_has_a_plausible_doi() -> None:
    known = read_references()
    cited = {found[1] for name in NAMES for found in CITATION.finditer(prose_text(name))}
    assert cited == set(known)
    assert len(known) >= 12
    for key, one in known.items():
        assert re.fullmatch(r"10\.\d{4,5}/\S+", one.doi), key
        assert str(one.year) in one.short and key.endswith(str(one.year))


def test_mathematics_of_a_notebook_becomes_mathml() -> None:
    made = plain_markdown("Of $\\cos^{n}\\theta$ and\n\n$$\\int_0^1 x\\,\\mathrm{d}x = \\tfrac12$$")
    assert made.count("<math") == 2
    assert '<mi mathvariant="normal">' in made
    assert "$" not in made


def test_formulas_of_the_prose_are_understood() -> None:
    for name in NAMES:
        for found in MATH.finditer(HOLE.sub("1", prose_text(name))):
            made = prose.mathml(found[1] or found[2])
            assert "\\" not in made, found[0]
