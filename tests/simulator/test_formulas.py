"""Emitted GLSL, compiled and run by a browser, against the emitted Python: in single precision."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import symrender.leaves as emitted
from leaves.points import sample
from symrender.expression.formulas.every import LEAVES
from symrender.expression.leaf import Leaf
from symrender.leaves import values

PAGES = [leaf for leaf in LEAVES.values() if leaf.pages]
RUN = """([source, width]) => {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl || !gl.getExtension("EXT_color_buffer_float")) return "no float targets";
  const program = gl.createProgram();
  const vertex = `#version 300 es
    void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }`;
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, source]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) return gl.getShaderInfoLog(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return gl.getProgramInfoLog(program);
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, 1);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  gl.viewport(0, 0, width, 1);
  gl.useProgram(program);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const pixels = new Float32Array(4*width);
  gl.readPixels(0, 0, width, 1, gl.RGBA, gl.FLOAT, pixels);
  return Array.from(pixels.filter((_, k) => k % 4 === 0));
}"""


def shader(asked: list[tuple[Leaf, list[float]]]) -> tuple[str, int]:
    """A pixel for every result of every call; ``nothing`` is a uniform 0, so that a compiler computes none of it."""
    text = (Path(emitted.__file__).parent / "formulas.glsl").read_text("utf-8")
    lines, pixel = [], 0
    for leaf, numbers in asked:
        given = ", ".join(f"{x!r} + nothing" if "e" not in repr(x) else f"float({x!r}) + nothing" for x in numbers)
        names = leaf.result_names
        if len(names) == 1:
            lines.append(f"  if (at == {pixel}) color.x = {leaf.name}({given});")
        else:
            slots = [f"r{pixel + k}" for k in range(len(names))]
            lines.append(f"  float {', '.join(slots)};\n  {leaf.name}({given}, {', '.join(slots)});")
            lines += [f"  if (at == {pixel + k}) color.x = {slot};" for k, slot in enumerate(slots)]
        pixel += len(names)
    head = "#version 300 es\nprecision highp float;\nuniform float nothing;\nout vec4 color;\n"
    body = "\n".join(lines)
    return f"{head}{text}\nvoid main() {{\n  int at = int(gl_FragCoord.x);\n  color = vec4(0.0);\n{body}\n}}\n", pixel


def test_glsl_computes_what_python_does(browser: Any) -> None:
    rng = np.random.default_rng(5)
    asked = []
    for leaf in PAGES:
        numbers = [float(np.float32(x)) for x in sample(leaf, rng)]
        asked.append((leaf, numbers))
    source, width = shader(asked)
    page = browser.new_page()
    told = page.evaluate(RUN, [source, width])
    page.close()
    assert not isinstance(told, str), told
    assert len(told) == width > 40
    wanted = np.concatenate([np.atleast_1d(getattr(values, leaf.name)(*numbers)) for leaf, numbers in asked])
    error = np.abs(np.array(told) - wanted) / np.maximum(np.abs(wanted), 0.05)
    assert np.isfinite(told).all()
    assert (np.abs(wanted) > 1e-3).mean() > 0.8
    # a float's rounding, times the exponents and frequencies that multiply it
    assert error.max() < 2e-4, sorted(
        zip(error, [leaf.name for leaf, _ in asked for _ in leaf.result_names], strict=True)
    )[-3:]
    assert np.median(error) < 3e-7
