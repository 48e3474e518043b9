#!/usr/bin/env python3
"""Runs the commands of a page of the docs: every line of its ```sh blocks, in order, in one shell.

    tutorial_test.py PAGE PROGRAM      in a temporary folder; exit code 1 with the first line that failed
"""
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def main():
    page, program = Path(sys.argv[1]), Path(sys.argv[2]).resolve()
    blocks = re.findall(r"^```sh\n(.*?)^```$", page.read_text(), re.M | re.S)
    assert len(blocks) > 3, f"{page} has no lines to run"
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}"}
        script = "set -ex\n" + "".join(blocks)
        done = subprocess.run(["bash", "-c", script], cwd=folder, env=environment, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{page}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
        out = Path(folder, "out")
        assert len(list((out / "frames").iterdir())) == 12, "frames are missing"
        kinds = done.stdout
        assert "copied" in kinds and "unobserved" in kinds, kinds
    print(f"{page.name}: {sum(block.count(chr(10)) for block in blocks)} lines ran")


if __name__ == "__main__":
    main()
