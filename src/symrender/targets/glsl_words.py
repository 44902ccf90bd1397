"""What GLSL ES 3.00 reserves, and elementary functions of known accuracy for it.

They are our own where a driver's are not accurate to float32: software drivers were seen to err by 2e-4 in sin and cos
and 1e-4 in acos, which a difference of two images would show. Coefficients after S. L. Moshier, *Cephes Mathematical
Library*, single precision.
"""

from __future__ import annotations

from typing import Final

RESERVED: Final = frozenset(
    [
        "attribute",
        "uniform",
        "varying",
        "layout",
        "centroid",
        "flat",
        "smooth",
        "break",
        "continue",
        "do",
        "for",
        "while",
        "switch",
        "case",
        "default",
        "if",
        "else",
        "in",
        "out",
        "inout",
        "true",
        "false",
        "invariant",
        "discard",
        "return",
        "lowp",
        "mediump",
        "highp",
        "precision",
        "sampler",
        "struct",
        "common",
        "partition",
        "active",
        "asm",
        "class",
        "union",
        "enum",
        "typedef",
        "template",
        "this",
        "resource",
        "goto",
        "inline",
        "noinline",
        "volatile",
        "public",
        "static",
        "extern",
        "external",
        "interface",
        "long",
        "short",
        "double",
        "half",
        "fixed",
        "unsigned",
        "superp",
        "input",
        "output",
        "filter",
        "sizeof",
        "cast",
        "namespace",
        "using",
        "shared",
        "patch",
        "sample",
        "subroutine",
        "coherent",
        "restrict",
        "readonly",
        "writeonly",
        "noise",
        "radians",
        "degrees",
        "sin",
        "cos",
        "tan",
        "asin",
        "acos",
        "atan",
        "sinh",
        "cosh",
        "tanh",
        "pow",
        "exp",
        "log",
        "exp2",
        "log2",
        "sqrt",
        "abs",
        "sign",
        "floor",
        "trunc",
        "round",
        "ceil",
        "fract",
        "mod",
        "modf",
        "min",
        "max",
        "clamp",
        "mix",
        "step",
        "smoothstep",
        "isnan",
        "isinf",
        "length",
        "distance",
        "dot",
        "cross",
        "normalize",
        "reflect",
        "refract",
        "main",
        "result",
    ]
)
HELPERS: Final[dict[str, tuple[tuple[str, ...], str]]] = {
    "own_sqrt": ((), "float own_sqrt(float x) { return sqrt(max(x, 0.0)); }"),
    "own_sine": (
        (),
        """float own_sine(float x, float quarters) {
  // a whole number of quarter turns taken off in three parts; what is left lies in [-pi/4, pi/4]
  float k = floor(x*0.636619772 + 0.5);
  float r = ((x - k*1.5703125) - k*4.83751297e-4) - k*7.54978997e-8;
  float z = r*r;
  int turn = int(k + quarters) & 3;
  float s = ((-1.9515295891e-4*z + 8.3321608736e-3)*z - 1.6666654611e-1)*z*r + r;
  float c = ((2.443315711809948e-5*z - 1.388731625493765e-3)*z + 4.166664568298827e-2)*z*z - 0.5*z + 1.0;
  float value = (turn & 1) == 1 ? c : s;
  return turn > 1 ? -value : value;
}""",
    ),
    "own_sin": (("own_sine",), "float own_sin(float x) { return own_sine(x, 0.0); }"),
    "own_cos": (("own_sine",), "float own_cos(float x) { return own_sine(x, 1.0); }"),
    "own_asin": (
        (),
        """float own_asin(float x) {
  float a = min(abs(x), 1.0);
  bool wide = a > 0.5;
  float z = wide ? 0.5*(1.0 - a) : a*a;
  float s = wide ? sqrt(z) : a;
  float p = (((4.2163199048e-2*z + 2.4181311049e-2)*z + 4.5470025998e-2)*z + 7.4953002686e-2)*z + 1.6666752422e-1;
  float y = p*z*s + s;
  y = wide ? 1.57079632679 - 2.0*y : y;
  return x < 0.0 ? -y : y;
}""",
    ),
    "own_acos": (
        (),
        """float own_acos(float x) {
  float a = min(abs(x), 1.0);
  bool wide = a > 0.5;
  float z = wide ? 0.5*(1.0 - a) : a*a;
  float s = wide ? sqrt(z) : a;
  float p = (((4.2163199048e-2*z + 2.4181311049e-2)*z + 4.5470025998e-2)*z + 7.4953002686e-2)*z + 1.6666752422e-1;
  float t = p*z*s + s;
  float y = wide ? 2.0*t : 1.57079632679 - t;
  return x < 0.0 ? 3.14159265359 - y : y;
}""",
    ),
    "own_atan2": (
        (),
        """float own_atan2(float y, float x) {
  float a = abs(y), b = abs(x);
  float high = max(a, b), low = min(a, b);
  if (high == 0.0) { return 0.0; }
  float t = low/high;
  float base = 0.0;
  if (t > 0.414213562) { base = 0.785398163397; t = (low - high)/(low + high); }
  float z = t*t;
  float v = base + ((((8.05374449538e-2*z - 1.38776856032e-1)*z + 1.99777106478e-1)*z - 3.33329491539e-1)*z*t + t);
  v = a > b ? 1.57079632679 - v : v;
  v = x < 0.0 ? 3.14159265359 - v : v;
  return y < 0.0 ? -v : v;
}""",
    ),
    "own_exp": ((), "float own_exp(float x) { return exp2(x*1.44269504); }"),
    "own_series": (
        (),
        """float own_series(float s) {
  // log((1 + s)/(1 - s))
  float z = s*s;
  return 2.0*s + 2.0*s*z*(0.33333333 + z*(0.2 + z*(0.14285714 + z*0.11111111)));
}""",
    ),
    "own_log": (
        ("own_series",),
        """float own_log(float x) {
  if (x <= 0.0) { return -3.402823e38; }
  int bits = floatBitsToInt(x);
  int e = (bits >> 23) - 127;
  float m = intBitsToFloat((bits & 8388607) | 1065353216);
  if (m > 1.41421356) { m *= 0.5; e += 1; }
  return float(e)*0.693359375 + (own_series((m - 1.0)/(m + 1.0)) - float(e)*2.12194440e-4);
}""",
    ),
    "own_log1p": (
        ("own_series",),
        "float own_log1p(float x) { return abs(x) < 0.25 ? own_series(x/(2.0 + x)) : 0.69314718*log2(1.0 + x); }",
    ),
    "own_expm1": (
        ("own_exp",),
        """float own_expm1(float x) {
  if (abs(x) > 0.5) { return own_exp(x) - 1.0; }
  return x*(1.0 + x*(0.5 + x*(0.16666667 + x*(4.1666667e-2 + x*(8.3333333e-3 + x*(1.3888889e-3
    + x*(1.9841270e-4 + x*2.4801587e-5)))))));
}""",
    ),
    "own_pow": (
        ("own_exp", "own_log"),
        "float own_pow(float x, float y) { return y == 0.0 ? 1.0 : x <= 0.0 ? 0.0 : own_exp(y*own_log(x)); }",
    ),
    "own_modulo": ((), "int own_modulo(int a, int b) { int r = a - (a/b)*b; return r < 0 ? r + b : r; }"),
}
FUNCTIONS: Final = {
    **{name: f"own_{name}" for name in ("sin", "cos", "asin", "acos", "atan2", "exp", "log", "log1p", "expm1")},
    **{name: f"own_{name}" for name in ("sqrt", "pow", "modulo")},
    **{name: name for name in ("floor", "abs", "max", "min", "mod")},
}
