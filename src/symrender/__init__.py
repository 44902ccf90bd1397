"""symrender: the oracle for rendering, the image that other renderers are tested against.

::

    import symrender as sr

    pair = sr.render("gloss", size=256)   # pair.numeric, pair.symbolic, pair.ledger
    held = sr.expression("gloss")         # the integrand: print it, differentiate it, evaluate it to 50 digits
    true = sr.truth("gloss", size=64)     # every pixel with its error
    sr.compare(true, pair.symbolic)

Names are looked up on first use, so importing symrender loads neither SymPy nor Numba.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from symrender.version import VERSION as __version__

if TYPE_CHECKING:
    from symrender.audit.audit import audit
    from symrender.audit.verdict import Verdict
    from symrender.bridge.export import export
    from symrender.errors import SymrenderError
    from symrender.expression.integrand import expression
    from symrender.fit import Fit, fit
    from symrender.gradient import gradient
    from symrender.hessian import Hessian, hessian
    from symrender.images.image import Image, read_image
    from symrender.ledger.compare import compare
    from symrender.probe import probe
    from symrender.render import Pair, render
    from symrender.report.build import Report, report
    from symrender.scene.load import load_any as load
    from symrender.scene.scene import Scene
    from symrender.sequences.film import animate
    from symrender.simulator.build import simulator
    from symrender.truth import truth
    from symrender.widget.explore import explore

_HOMES = {
    "Fit": "symrender.fit",
    "Hessian": "symrender.hessian",
    "Image": "symrender.images.image",
    "Pair": "symrender.render",
    "Report": "symrender.report.build",
    "Scene": "symrender.scene.scene",
    "SymrenderError": "symrender.errors",
    "Verdict": "symrender.audit.verdict",
    "animate": "symrender.sequences.film",
    "audit": "symrender.audit.audit",
    "compare": "symrender.ledger.compare",
    "explore": "symrender.widget.explore",
    "export": "symrender.bridge.export",
    "expression": "symrender.expression.integrand",
    "fit": "symrender.fit",
    "gradient": "symrender.gradient",
    "hessian": "symrender.hessian",
    "load": "symrender.scene.load",
    "read_image": "symrender.images.image",
    "probe": "symrender.probe",
    "render": "symrender.render",
    "report": "symrender.report.build",
    "simulator": "symrender.simulator.build",
    "truth": "symrender.truth",
}

_OTHERWISE = {"load": "load_any"}
"""What is called otherwise where it lives."""

__all__ = [
    "Fit",
    "Hessian",
    "Image",
    "Pair",
    "Report",
    "Scene",
    "SymrenderError",
    "Verdict",
    "__version__",
    "animate",
    "audit",
    "compare",
    "explore",
    "export",
    "expression",
    "fit",
    "gradient",
    "hessian",
    "load",
    "probe",
    "read_image",
    "render",
    "report",
    "simulator",
    "truth",
]


class _Package(ModuleType):
    """Keeps ``symrender.render`` the function although a submodule has that name too."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOMES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)

    def __getattr__(self, name: str) -> Any:
        if name not in _HOMES:
            raise AttributeError(f"module 'symrender' has no attribute {name!r}")
        value = getattr(import_module(_HOMES[name]), _OTHERWISE.get(name, name))
        super().__setattr__(name, value)
        return value

    def __dir__(self) -> list[str]:
        return __all__


sys.modules[__name__].__class__ = _Package
