"""Helpers of translated code in LLVM IR: division towards minus infinity, powers by squaring, external functions."""

from __future__ import annotations

from typing import Final

HELPERS: Final = {
    "int_floordiv": """
define internal i64 @int_floordiv(i64 %x, i64 %y) alwaysinline {
  %zero = icmp eq i64 %y, 0
  %least = icmp eq i64 %x, -9223372036854775808
  %minus = icmp eq i64 %y, -1
  %over = and i1 %least, %minus
  %bad = or i1 %zero, %over
  br i1 %bad, label %none, label %fine
none:
  ret i64 0
fine:
  %q = sdiv i64 %x, %y
  %r = srem i64 %x, %y
  %s = xor i64 %y, %r
  %differ = icmp slt i64 %s, 0
  %some = icmp ne i64 %r, 0
  %down = and i1 %some, %differ
  %less = sub i64 %q, 1
  %out = select i1 %down, i64 %less, i64 %q
  ret i64 %out
}""",
    "int_mod": """
define internal i64 @int_mod(i64 %x, i64 %y) alwaysinline {
  %zero = icmp eq i64 %y, 0
  %least = icmp eq i64 %x, -9223372036854775808
  %minus = icmp eq i64 %y, -1
  %over = and i1 %least, %minus
  %bad = or i1 %zero, %over
  br i1 %bad, label %none, label %fine
none:
  ret i64 0
fine:
  %r = srem i64 %x, %y
  %s = xor i64 %y, %r
  %differ = icmp slt i64 %s, 0
  %some = icmp ne i64 %r, 0
  %up = and i1 %some, %differ
  %more = add i64 %r, %y
  %out = select i1 %up, i64 %more, i64 %r
  ret i64 %out
}""",
    "float_mod": """
define internal double @float_mod(double %x, double %y) {
  %r = frem double %x, %y
  %zero = fcmp oeq double %y, 0.0
  br i1 %zero, label %plain, label %divide
plain:
  ret double %r
divide:
  %some = fcmp une double %r, 0.0
  %below = fcmp olt double %y, 0.0
  br i1 %some, label %rest, label %none
rest:
  %minus = fcmp olt double %r, 0.0
  %differ = icmp ne i1 %below, %minus
  %more = fadd double %r, %y
  %moved = select i1 %differ, double %more, double %r
  ret double %moved
none:
  %square = fmul double %r, %r
  %turned = fneg double %square
  %signed = select i1 %below, double %turned, double %square
  ret double %signed
}""",
    "float_floordiv": """
declare double @llvm.floor.f64(double)
define internal double @float_floordiv(double %x, double %y) {
  %zero = fcmp oeq double %y, 0.0
  br i1 %zero, label %plain, label %divide
plain:
  %inf = fdiv double %x, %y
  ret double %inf
divide:
  %r = frem double %x, %y
  %taken = fsub double %x, %r
  %q = fdiv double %taken, %y
  %some = fcmp une double %r, 0.0
  %below = fcmp olt double %y, 0.0
  %minus = fcmp olt double %r, 0.0
  %differ = icmp ne i1 %below, %minus
  %down = and i1 %some, %differ
  %less = fsub double %q, 1.0
  %div = select i1 %down, double %less, double %q
  %whole = fcmp une double %div, 0.0
  br i1 %whole, label %snap, label %none
snap:
  %low = call double @llvm.floor.f64(double %div)
  %gap = fsub double %div, %low
  %far = fcmp ogt double %gap, 0.5
  %next = fadd double %low, 1.0
  %near = select i1 %far, double %next, double %low
  ret double %near
none:
  %square = fmul double %div, %div
  %product = fmul double %square, %x
  %signed = fdiv double %product, %y
  ret double %signed
}""",
    "float_power": """
declare double @llvm.pow.f64(double, double)
define internal double @float_power(double %x, i64 %n) {
  %minus = icmp slt i64 %n, 0
  %turned = sub i64 0, %n
  %count = select i1 %minus, i64 %turned, i64 %n
  %many = icmp sgt i64 %count, 65536
  br i1 %many, label %general, label %head
general:
  %exponent = sitofp i64 %count to double
  %any = call double @llvm.pow.f64(double %x, double %exponent)
  ret double %any
head:
  %left = phi i64 [ %count, %0 ], [ %halved, %head.next ]
  %result = phi double [ 1.0, %0 ], [ %taken, %head.next ]
  %factor = phi double [ %x, %0 ], [ %square, %head.next ]
  %more = icmp ne i64 %left, 0
  br i1 %more, label %head.next, label %end
head.next:
  %bit = and i64 %left, 1
  %odd = icmp ne i64 %bit, 0
  %times = fmul double %result, %factor
  %taken = select i1 %odd, double %times, double %result
  %halved = ashr i64 %left, 1
  %square = fmul double %factor, %factor
  br label %head
end:
  %inverse = fdiv double 1.0, %result
  %out = select i1 %minus, double %inverse, double %result
  ret double %out
}""",
}
"""Definitions by name; a line that declares is needed once a module."""

EXTERNAL: Final = {
    "ldexp": "declare double @ldexp(double, i32 signext) #2",
    "llvm.memmove.p0.p0.i64": "declare void @llvm.memmove.p0.p0.i64(ptr, ptr, i64, i1)",
    "llvm.fabs.v4f64": "declare <4 x double> @llvm.fabs.v4f64(<4 x double>)",
    **{name: f"declare double @{name}(double, double)" for name in ("llvm.pow.f64", "llvm.copysign.f64")},
    **{name: f"declare double @{name}(double, double) #2" for name in ("atan2", "hypot")},
    **{
        name: f"declare double @{name}(double)"
        for name in (
            "llvm.sqrt.f64", "llvm.exp.f64", "llvm.log.f64", "llvm.log10.f64", "llvm.sin.f64", "llvm.cos.f64",
            "llvm.fabs.f64", "llvm.floor.f64", "llvm.ceil.f64", "llvm.trunc.f64",
        )
    },
    **{
        name: f"declare double @{name}(double) #2"
        for name in (
            "log1p", "expm1", "tan", "asin", "acos", "atan", "asinh", "acosh", "atanh", "sinh", "cosh", "tanh", "log2",
            "erf", "erfc",
        )
    },
}  # fmt: skip
"""Declarations of functions of the C library and of LLVM; #2 says that they touch no memory."""
