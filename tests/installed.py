"""Runs the command line and the public functions in an environment under test; one line of JSON for each run.

    python installed.py base | few | EXTRA

``base`` runs every verb over every scene of the gallery, ``few`` a handful, and the name of an extra what it serves.
It is started in an empty folder by an interpreter that holds symrender, and needs nothing else.
"""

from __future__ import annotations

import contextlib
import io
import json
import sys
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

FINE = (0, 4)
"""Exit codes of a run that worked: 4 is a tolerance that was missed."""
MARBLE = """
units: radiometric
name: marbled
bounces: 1
camera: {type: look_at, eye: [0, -6, 2], target: [0, 0, 0.5], fov: 30}
materials:
  veins: {type: diffuse, reflectance: {type: marble, bright: 0.8, dark: 0.2, cell: 1}}
  clay: {type: diffuse, reflectance: 0.5}
shapes:
  - {type: plane, name: floor, point: [0, 0, 0], normal: [0, 0, 1], material: veins}
  - {type: sphere, name: A, center: [0, 0, 0.6], radius: 0.6, material: clay}
lights:
  - {type: point, name: key, position: [-3, -4, 5], intensity: 60}
"""
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""


def tell(what: str, code: int, fault: str) -> None:
    """Print one run."""
    print(json.dumps({"what": what, "code": code, "fault": fault}), flush=True)


def verb(*words: str, fine: tuple[int, ...] = FINE, refused: bool = True) -> int:
    """Run the command line; a refusal is one line on stderr, and no fault where that may be."""
    from symrender.cli import main

    out, err = io.StringIO(), io.StringIO()
    fault = ""
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main(list(words))
    except (Exception, SystemExit):
        code, fault = 70, traceback.format_exc()[-600:]
    said = [line for line in err.getvalue().splitlines() if line.strip()]
    if code == 2 and refused and said and said[-1].startswith("ERROR "):
        tell(" ".join(words), code, fault)
        return code
    if code not in fine:
        fault = fault or " ".join(said)[-600:] or f"exit code {code}"
    if any("Warning" in line or "Traceback" in line for line in said):
        fault = " ".join(said)[-600:]
    tell(" ".join(words), code, fault)
    return code


def call(name: str, work: Callable[[], object]) -> None:
    """Call a public function; a refusal is one of our own errors."""
    from symrender.errors import SymrenderError

    try:
        work()
        tell(name, 0, "")
    except SymrenderError as error:
        tell(name, 2, "" if str(error) else "an error without a message")
    except Exception:
        tell(name, 70, traceback.format_exc()[-600:])


def of_scene(name: str, number: str) -> None:
    """Every verb that takes a scene."""
    out = f"{name}_out"
    small = ("--size", "4", "--force", "--quiet")
    verb("info", name) if Path(name).exists() else verb("scenes", name)
    verb("params", name)
    verb("cite", name)
    verb("render", name, *small, "--out", out)
    verb("truth", name, *small, "--tol", "1e-2", "--out", out)
    verb("truth", name, *small, "--tol", "1e-1", "--filter", "box", "--out", f"{out}_box")
    verb("gradient", name, *small, "--tol", "1e-1", "--wrt", number, "--out", f"{out}_slopes")
    verb("probe", name, "-p", "0.1,0.2", "--tol", "1e-2")
    verb("probe", name, "--ray", "0,-6,2,0,6,-1.8", "--tol", "1e-2")
    verb("probe", name, "--ray", "0,-6,2,0,6,-1.8", "--tol", "1e-1", "--wrt", number)
    verb("expression", name)
    verb("export", name, "--to", "glsl", "--force", "--quiet", "--out", f"{out}.glsl")
    verb("export", name, "--to", "mitsuba", "--size", "4", "--force", "--quiet", "--out", f"{out}_mitsuba")
    verb("export", name, "--to", "pbrt", "--size", "4", "--force", "--quiet", "--out", f"{out}_pbrt")
    if Path(f"{out}_mitsuba/scene.xml").exists():
        verb("convert", f"{out}_mitsuba/scene.xml", f"{out}_back.yaml", "--force", "--quiet")
    verb("animate", name, "--orbit", "2", *small, "--video", "none", "--lobe", "2", "--out", f"{out}_turn")
    verb("sweep", name, "--over", f"{number}=.5:.6:2", *small, "--lobe", "2", "--out", f"{out}_sweep")
    verb("simulator", name, "--force", "--quiet", "--out", f"{out}.html")
    verb("demo", name, *small, "--lobe", "2", "--out", f"{out}_demo")
    image = f"{out}/truth.npz"
    if Path(image).exists():
        verb("info", image)
        verb("view", image, "--force", "--quiet", "--out", f"{out}.png")
        verb("compare", image, image, "--quiet")
        verb("audit", image, "--scene", name, "--noise-free", "--quiet", "--force", fine=(0, 1, 4))
        verb("fit", name, image, "--free", number, "--tol", "1e-2", "--iterations", "1", "--quiet")


def first_number(name: str) -> str:
    """A number of a light or, without lights, of the camera, by which images differ."""
    import symrender as sr

    scene = sr.load(name)
    names = [each.name for each in scene.parameters() if isinstance(each.value, float)]
    lights = [each for each in names if each.startswith(("lights.", "ambient"))]
    return (lights or names)[0]


def once() -> None:
    """Verbs that take no scene of the gallery, or one that stands for all."""
    verb("doctor", refused=False)
    verb("scenes", refused=False)
    for kind in ("convergence", "weights", "budget", "timing", "anchor", "pitfalls"):
        verb("study", kind, "--size", "8", "--quiet", "--no-plot" if kind == "convergence" else "--json")
    verb("suite", "--size", "4", "--force", "--quiet", "--tol", "1e-2", "--out", "suite")
    verb("lab", "--out", "lab", "--force")
    verb("chapter", "--out", "chapter", "--force")


def functions() -> None:
    """Every public function, called as a user would."""
    import symrender as sr

    called = {
        "load": lambda: sr.load("gloss"),
        "render": lambda: sr.render("gloss", size=4, lobe=2),
        "truth": lambda: sr.truth("gloss", size=4, tol=1e-2).save("truth.npz"),
        "read_image": lambda: sr.read_image("truth.npz"),
        "compare": lambda: sr.compare(sr.read_image("truth.npz"), sr.read_image("truth.npz")),
        "probe": lambda: sr.probe("gloss", [[0.1, 0.2]], tol=1e-3),
        "gradient": lambda: sr.gradient("gloss", ["ambient"], size=4, tol=1e-1),
        "hessian": lambda: sr.hessian("metal", ["lights.key.intensity.r"], size=2, tol=1e-1),
        "fit": lambda: sr.fit("gloss", sr.read_image("truth.npz"), ["ambient.r"], tol=1e-2, iterations=1),
        "expression": lambda: sr.expression("gloss"),
        "export": lambda: sr.export("gloss", "glsl"),
        "simulator": lambda: sr.simulator("gloss"),
        "animate": lambda: sr.animate("gloss", "turn", orbit=2, size=4, video="none"),
        "explore": lambda: sr.explore("gloss"),
        "report": lambda: sr.report("gloss"),
        "audit": lambda: sr.audit("truth.npz", "gloss", noise_free=True),
    }
    types = {"Fit", "Hessian", "Image", "Pair", "Report", "Scene", "SymrenderError", "Verdict", "__version__"}
    for name, work in called.items():
        call(f"sr.{name}", work)
    left = set(sr.__all__) - set(called) - types
    tell("all public names", 0, f"not called: {sorted(left)}" if left else "")


def gallery() -> Iterator[str]:
    """The names of the scenes of the gallery."""
    from symrender.scene import gallery as scenes

    yield from scenes.all_names()


def base() -> None:
    """Everything, over all scenes."""
    Path("marbled.yaml").write_text(MARBLE, encoding="utf-8")
    once()
    functions()
    for name in ("marbled.yaml", *gallery()):
        of_scene(name, first_number(name))


def few() -> None:
    """A handful of what ``base`` runs: what needs most of the packages."""
    Path("marbled.yaml").write_text(MARBLE, encoding="utf-8")
    verb("doctor", refused=False)
    verb("truth", "marbled.yaml", "--size", "4", "--tol", "1e-1", "--quiet", "--out", "out", refused=False)
    verb("fit", "marbled.yaml", "out/truth.npz", "--free", "lights.key.intensity.r", "--tol", "1e-1",
         "--iterations", "1", "--quiet", refused=False)  # fmt: skip
    verb("expression", "mirror", refused=False)
    verb("compare", "out/truth.exr", "out/truth.npz", "--quiet", "--max-abs", "1e-6", refused=False)
    verb("view", "out/truth.exr", "--quiet", "--out", "view.png", refused=False)


def certify() -> None:
    verb("probe", "chapter8", "-p", "1.2,-0.4", "--tol", "1e-3", "--certify", refused=False)


def dist() -> None:
    verb("render", "gloss", "--size", "4", "--quiet", "--cluster", "local:1", "--out", "out", refused=False)


def notebook() -> None:
    verb("lab", "--out", "lab", "--force", refused=False)


def chapter() -> None:
    from symrender.chapter.document import plots, prose  # noqa: F401

    tell("chapter imports", 0, "")


def flip() -> None:
    verb("truth", "mirror", "--size", "8", "--quiet", "--out", "out", refused=False)
    verb("compare", "out/truth.npz", "out/truth.npz", "--flip", "--quiet", refused=False)


def mesh() -> None:
    import symrender as sr

    Path("one.ply").write_text(PLY, encoding="ascii")
    text = MARBLE.replace(
        "type: sphere, name: A, center: [0, 0, 0.6], radius: 0.6", "type: mesh, name: A, file: one.ply"
    )
    Path("meshed.yaml").write_text(text.replace("bounces: 1", "bounces: 0"), encoding="utf-8")
    call("a mesh in PLY", lambda: sr.truth("meshed.yaml", size=4, tol=1e-1))


def video() -> None:
    verb("animate", "mirror", "--orbit", "2", "--size", "16", "--lobe", "2", "--quiet", "--out", "turn", refused=False)


def widget() -> None:
    import symrender as sr

    call("sr.explore", lambda: sr.explore("gloss"))


def all_of_them() -> None:
    """What each extra serves, with all of them there."""
    for each in (certify, dist, notebook, chapter, flip, mesh, video, widget):
        each()


if __name__ == "__main__":
    served = {each.__name__: each for each in (base, few, certify, dist, notebook, chapter, flip, mesh, video, widget)}
    (served | {"all": all_of_them})[sys.argv[1]]()
