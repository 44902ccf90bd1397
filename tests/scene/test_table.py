"""The notebook table shows every parameter and no markup of the scene's."""

from __future__ import annotations

from symrender.scene.load import load


def test_table() -> None:
    scene = load("gloss").replace({"name": "</script><script>alert(1)</script>&"})
    html = scene._repr_html_()
    assert "<caption>&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;</caption>" in html
    assert html.count("<tr>") == 1 + len(scene.parameters())
    assert "<td>spheres.A.center.x</td><td>-0.72</td><td>length</td><td>-1e12</td><td>1e12</td>" in html
