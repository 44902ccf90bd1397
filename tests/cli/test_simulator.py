"""``symrender simulator``: the file it writes, and the page it serves until it is interrupted."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import urllib.request

import pytest

from symrender.cli import main
from symrender.simulator.build import simulator

MAIN = "import sys; from symrender.cli import main; sys.exit(main(sys.argv[1:]))"
COMMAND = (sys.executable, "-c", MAIN, "simulator", "furnace")


@pytest.fixture(scope="module")
def page():
    return simulator("furnace").html


def test_it_writes_one_page_and_says_how_large(page, tmp_path, capfd):
    out = tmp_path / "page.html"
    assert main(["simulator", "furnace", "-o", str(out)]) == 0
    assert re.fullmatch(rf"wrote {re.escape(str(out))} \(\d+ kB\)", capfd.readouterr().out.strip())
    assert out.read_text(encoding="utf-8") == page
    assert main(["simulator", "furnace", "-o", str(out)]) != 0
    said = capfd.readouterr().err
    assert "page.html" in said and "Traceback" not in said


def test_it_serves_the_page_until_it_is_interrupted(page, tmp_path):
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(
        [*COMMAND, "--serve"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path, env=environment
    ) as process:
        try:
            line = process.stdout.readline()
            address = re.match(r"http://127\.0\.0\.1:\d+/", line)
            assert address is not None, line
            with urllib.request.urlopen(address.group(0), timeout=60) as answer:
                # a page that is served may ask its own server, and says so; else it is the page of a file
                served = answer.read().decode()
                told = served.replace("; connect-src &#x27;self&#x27;", "", 1).replace(
                    '"served":true', '"served":false', 1
                )
                assert told == page != served
            process.send_signal(signal.SIGINT)
            _, said = process.communicate(timeout=60)
        finally:
            process.kill()
    assert process.returncode == 130
    assert "Traceback" not in said
    assert list(tmp_path.iterdir()) == []
