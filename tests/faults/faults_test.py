#!/usr/bin/env python3
"""Tests the comparison of results, and the scenarios, with a script instead of the program."""
import random
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fuzz"))

import results  # noqa: E402
import scenarios  # noqa: E402
from program import Program  # noqa: E402

# OUT is $4. The careless program uses an existing file without checking it.
CARELESS = ('mkdir -p $4/.dvi/frames $4/.dvi/stages $4/frames\n[ -e $4/frames/000001.png ] || cat $2/in.txt > $4/frames/000001.png\n'
            'echo "{}" > $4/report.json\necho record > $4/.dvi/frames/000001.json\n'
            'for s in poses map exposure alignment; do [ -e $4/.dvi/stages/$s.json ] || { echo $s > $4/.dvi/stages/$s.bin;'
            ' echo record > $4/.dvi/stages/$s.json; sleep 0.01; }; done\n')
CAREFUL = CARELESS.replace("[ -e $4/frames/000001.png ] || ", "")


class Faults(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        (self.folder / "drive").mkdir()
        (self.folder / "drive/in.txt").write_text("picture\n")

    def scene(self, script, seed=1):
        path = self.folder / "program.sh"
        path.write_text("#!/bin/sh\n" + script)
        path.chmod(0o755)
        program, complete, case = Program(path, 20), self.folder / "complete", self.folder / f"case-{seed}"
        self.assertEqual(program.call("run", self.folder / "drive", "-o", complete).code, 0)
        case.mkdir()
        undisturbed = SimpleNamespace(drive=self.folder / "drive", out=complete, seconds=0.05,
                                      expected=results.contents(complete))
        return scenarios.Scene(program, undisturbed, case, random.Random(seed))

    def test_times_and_records_are_not_compared(self):
        out = self.folder / "out"
        (out / ".dvi").mkdir(parents=True)
        (out / "report.json").write_text('{"hole": 1, "cost": {"seconds": 1}}')
        (out / "dvi.toml").write_text("[job]\nout = '/a'\n")
        expected = results.contents(out)
        (out / "report.json").write_text('{"cost": {"seconds": 2}, "hole": 1}')
        (out / "dvi.toml").write_text("[job]\nout = '/b'\n")
        (out / ".dvi/job.json").write_text("any")
        self.assertEqual(results.differences(expected, out), [])
        (out / "report.json").write_text('{"hole": 2}')
        (out / "more.png").write_bytes(b"")
        self.assertEqual(results.differences(expected, out),
                         ["result: not expected: more.png", "result: other than undisturbed: report.json"])

    def test_a_careful_program_passes(self):
        for seed, scenario in enumerate((scenarios.killed, scenarios.killed_after_stage, scenarios.stages_damaged, scenarios.damaged,
                                          scenarios.power_cut, scenarios.two_at_once)):
            self.assertEqual(scenario(self.scene(CAREFUL, seed))[1], [], scenario.__name__)

    def test_a_damaged_picture_is_found(self):
        found = [scenarios.damaged(self.scene(CARELESS, seed)) for seed in range(8)]
        self.assertTrue(any("other than undisturbed: frames/000001.png" in f for _, findings in found for f in findings), found)
        self.assertTrue(all(findings == [] for what, findings in found if "deleted" in what), found)

    def test_a_stage_that_is_made_again_is_found(self):
        forgetful = CAREFUL.replace("[ -e $4/.dvi/stages/$s.json ] ||", "")
        found = [scenarios.killed_after_stage(self.scene(forgetful, seed))[1] for seed in range(3)]
        self.assertTrue(any("was made again" in f for findings in found for f in findings), found)

    def test_each_kind_of_file_is_damaged(self):
        names = set()
        for seed in range(40):
            scene = self.scene(CAREFUL, seed)
            names.add(scenarios.damage(scene.complete, scene.rng, lambda name: "stages" not in name, scenarios.LOST)[0])
        self.assertEqual(names, {"frames/000001.png", "report.json", ".dvi/frames/000001.json"})


if __name__ == "__main__":
    unittest.main()
