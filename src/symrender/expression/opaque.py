"""Functions SymPy must not look inside: a rewriting would lose the digits they save."""

from __future__ import annotations

import sympy as sp


class log1p(sp.Function):
    """log(1 + x)."""

    nargs = 1

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """1/(1 + x)"""
        return 1 / (1 + self.args[0])

    def _eval_evalf(self, prec: int) -> sp.Expr:
        return sp.log(1 + self.args[0])._eval_evalf(prec)


class expm1(sp.Function):
    """exp(x) - 1."""

    nargs = 1

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """exp(x)"""
        return sp.exp(self.args[0])

    def _eval_evalf(self, prec: int) -> sp.Expr:
        return (sp.exp(self.args[0]) - 1)._eval_evalf(prec)


def plain(value: sp.Expr) -> sp.Expr:
    """An expression without them and without powers by logarithms, to be read."""
    return value.replace(log1p, lambda x: sp.log(1 + x)).replace(expm1, lambda x: sp.exp(x) - 1).replace(sp.exp, _power)


def _power(x: sp.Expr) -> sp.Expr:
    exponent, rest = x.as_independent(sp.log, as_Add=False)
    return rest.args[0] ** exponent if isinstance(rest, sp.log) else sp.exp(x)
