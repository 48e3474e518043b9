#!/usr/bin/env python3
"""slurm_test.py DVI: a drive through snakemake on Slurm, with a task killed, a node drained and the disk full for a while, has the
bytes of `dvi run`. Exit code 77 where Slurm, snakemake or root is missing, and unless DVI_TEST_SLURM is set: it takes minutes."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import cluster

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "faults"))
import results  # noqa: E402

DVI = Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else None
DEPLOY = HERE.parent.parent / "deploy"
FRAMES, FRAMES_PER_TASK = 200, 20
SBATCH = "sbatch --parsable --requeue -c {threads} --mem={resources.mem_mb} -t {resources.runtime} -o {log_folder}/%j.out"


class Disk:
    """A small file system that can be filled."""

    def __init__(self, folder, megabytes):
        self.folder, self.ballast = folder, folder / "ballast"
        folder.mkdir()
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "tmpfs", folder], check=True)

    def fill(self):
        with open(self.ballast, "wb") as ballast:
            try:
                while True:
                    ballast.write(bytes(1 << 16))
                    ballast.flush()
            except OSError:
                pass

    def free(self):
        self.ballast.unlink()

    def unmount(self):
        subprocess.run(["umount", "-l", self.folder], check=True)


class Slurm(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="dvi-slurm-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.disk = Disk(self.folder / "disk", 400)
        self.addCleanup(self.disk.unmount)
        self.drive, self.out = self.folder / "drive", self.disk.folder / "out"
        subprocess.run([DVI, "synth", "-o", self.drive, "--frames", str(FRAMES), "--width", "96", "--height", "64", "--beams", "16",
                        "--columns", "300", "--quiet"], check=True, stdout=subprocess.DEVNULL)
        subprocess.run([DVI, "run", self.drive, "-o", self.folder / "whole", "--quiet"], check=True, stdout=subprocess.DEVNULL)

    def fills(self):
        """Returns the numbers of the running fill jobs."""
        rows = self.slurm.call("squeue", "-h", "-t", "R", "-o", "%A %j").stdout.split("\n")
        return [row.split()[0] for row in rows if "fill" in row]

    def snakemake(self):
        (self.folder / "drives.tsv").write_text(f"{self.out}\t{self.drive}\n")
        log = open(self.folder / "snakemake.log", "wb")
        self.addCleanup(log.close)
        return subprocess.Popen(
            ["snakemake", "-s", DEPLOY / "Snakefile", "--jobs", "4", "--nolock", "--latency-wait", "20",
             "--cluster", SBATCH.replace("{log_folder}", str(self.folder)) + " -J {rule}",
             "--cluster-status", DEPLOY / "slurm_status.sh", "--config", f"drives={self.folder}/drives.tsv", f"dvi={DVI}",
             f"frames_per_task={FRAMES_PER_TASK}", "mem_mb=1000"],
            cwd=self.folder, env=self.slurm.environment, stdout=log, stderr=log)

    def done(self):
        return len(list((self.out / "frames").glob("*.png")))

    def text(self):
        return "".join(path.read_text(errors="replace") for path in sorted(self.folder.glob("*.out")))

    def test_faults_do_not_change_the_result(self):
        with cluster.Cluster(self.folder / "slurm") as self.slurm:
            snakemake = self.snakemake()
            self.addCleanup(snakemake.kill)
            self.slurm.wait(lambda: self.done() > 0, "a frame", 120)
            self.slurm.call("scancel", self.fills()[0])
            self.slurm.call("scontrol", "update", "NodeName=b", "State=DRAIN", "Reason=test")
            self.slurm.wait(lambda: self.done() > FRAMES // 3 and self.fills(), "a third of the frames", 180)
            self.disk.fill()
            self.slurm.wait(lambda: "No space left" in self.text() or "cannot be written" in self.text(), "a full disk", 60)
            self.disk.free()
            self.assertEqual(snakemake.wait(300), 0, (self.folder / "snakemake.log").read_text()[-4000:])
            states = re.findall(r"JobState=(\w+)", self.slurm.call("scontrol", "show", "job", "--oneliner").stdout)
        self.assertEqual(states.count("COMPLETED"), FRAMES // FRAMES_PER_TASK + 2, states)
        self.assertEqual(states.count("CANCELED"), 1, states)
        self.assertIn("Trying to restart job", self.text())  # snakemake, in the job whose disk was full
        self.assertEqual(results.differences(results.contents(self.folder / "whole"), self.out), [])


if __name__ == "__main__":
    why = "" if os.environ.get("DVI_TEST_SLURM") else "takes minutes; DVI_TEST_SLURM=1 asks for it"
    why = why or cluster.missing() or ("" if shutil.which("snakemake") else "not installed: snakemake")
    if why:
        print(f"skipped: {why}")
        sys.exit(77)
    unittest.main()
