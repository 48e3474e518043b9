#!/usr/bin/env python3
"""Tests the parsing of libFuzzer's output, with scripts instead of targets."""
import tempfile
import unittest
from pathlib import Path

import parsers

LOG = """#2\tINITED cov: 300 ft: 400 corp: 1/5b exec/s: 0 rss: 60Mb
#4096\tpulse  cov: 391 ft: 1110 corp: 80/4Kb lim: 40 exec/s: 2048 rss: 70Mb
#9000\tDONE   cov: 402 ft: 1200 corp: 90/5Kb lim: 43 exec/s: 3000 rss: 71Mb
stat::number_of_executed_units: 9001
"""


class Parsers(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def outcome(self, script):
        program = self.folder / "parse_ply"
        program.write_text("#!/bin/bash\n" + script)
        program.chmod(0o755)
        return parsers.run(program, 1, 1, self.folder / "findings")

    def test_counts_are_the_last(self):
        self.assertEqual(parsers.counts(LOG), (9001, 402, 1200))
        self.assertEqual(parsers.counts(LOG.replace("stat::", "")), (9000, 402, 1200))
        self.assertEqual(parsers.counts(""), (0, 0, 0))

    def test_the_first_fault_is_the_headline(self):
        log = "x.cpp:3:4: runtime error: nan is outside\nSUMMARY: y\n"
        self.assertEqual(parsers.headline(LOG + log), "x.cpp:3:4: runtime error: nan is outside")
        thrown = "terminate called after throwing an instance of 'std::out_of_range'\n  what():  at\n==1== ERROR: libFuzzer: deadly signal\n"
        self.assertEqual(parsers.headline(thrown), "terminate called after throwing an instance of 'std::out_of_range' what(): at")

    def test_a_quiet_target_has_no_findings(self):
        self.assertEqual(self.outcome(f"cat >&2 <<'END'\n{LOG}END\n"), parsers.Outcome("ply", 9001, 402, 1200, []))

    def test_a_finding_is_kept_and_repeatable(self):
        prefix = 'for a; do case $a in -artifact_prefix=*) echo bad >"${a#*=}crash-1";; esac; done\n'
        found = self.outcome(prefix + "echo 'ERROR: AddressSanitizer: heap-buffer-overflow' >&2; exit 77").findings
        kept = self.folder / "findings" / "ply-crash-1"
        self.assertEqual(kept.read_text(), "bad\n")
        self.assertEqual(found, [f"ERROR: AddressSanitizer: heap-buffer-overflow\n    {self.folder}/parse_ply {kept}"])

    def test_a_target_that_fails_otherwise_is_a_finding(self):
        self.assertIn("exit 3", self.outcome("exit 3").findings[0])


if __name__ == "__main__":
    unittest.main()
