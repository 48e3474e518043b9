#!/usr/bin/env python3
"""The parts of ./dev platforms that need neither root nor a mirror."""
import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import systems
from measure import Result, lintian_in, table, tests_in, warnings_in

LOG = """\
[1/9] Building CXX object a.o
/home/builder/dvi/src/dvi/a.cpp:3:5: warning: unused variable 'x' [-Wunused-variable]
/home/builder/dvi/src/dvi/a.cpp:3:5: warning: unused variable 'x' [-Wunused-variable]
/usr/include/c++/14/bits/stl_algo.h:7:1: warning: array subscript 4 is outside of array bounds [-Warray-bounds=]
/home/builder/dvi/src/dvi/b.cpp:4:5: note: warning: of a note is not counted
CMake Warning (dev) at CMakeLists.txt:33 (find_package):
dvi: warning: of the program itself is not counted
"""
TESTS = """\
98% tests passed, 2 tests failed out of 103

Total Test time (real) =  12.30 sec

The following tests did not run:
\t  7 - program.slurm (Skipped)
\t 19 - objects.Opsets.DetectorHeads/yolo (Skipped)

The following tests FAILED:
\t 12 - depth.Median (Failed)
"""
TARGETS = """\
Debian|Debian-Security|http://security.example/debian-security/
Debian|Debian|http://mirror.example/debian/
Debian|Debian|http://second.example/debian/
Other|Other|http://mirror.example/ubuntu/
"""


class Measures(unittest.TestCase):
    def test_warnings_of_compiler_and_cmake_are_counted_once(self):
        self.assertEqual([line.split(" ", 1)[0] for line in warnings_in(LOG)],
                         ["/home/builder/dvi/src/dvi/a.cpp:3:5:", "/usr/include/c++/14/bits/stl_algo.h:7:1:", "CMake"])

    def test_tests_are_read_from_the_summary_of_ctest(self):
        self.assertEqual(tests_in(TESTS), (99, 2, 2))
        self.assertEqual(tests_in("100% tests passed, 0 tests failed out of 5\n"), (5, 0, 0))
        self.assertIsNone(tests_in("ninja: build stopped\n"))

    def test_errors_and_warnings_of_lintian_are_separate(self):
        errors, warnings = lintian_in("N: a note\nE: dvi: no-changelog usr/share/doc\nW: dvi: groff-message\nI: dvi: spelling\n")
        self.assertEqual((errors, warnings), (["E: dvi: no-changelog usr/share/doc"], ["W: dvi: groff-message"]))


class Table(unittest.TestCase):
    def test_a_system_has_a_column_with_its_outcome(self):
        text = table([Result("debian13", {"./dev build, minutes": "9.1"}), Result("debian12", {"./dev build, minutes": "8.0"}, ["x"]),
                      Result("ubuntu24.04", untested="no mirror")])
        rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()]
        self.assertEqual(rows[0], ["", "debian13", "debian12", "ubuntu24.04"])
        self.assertEqual(rows[2], ["result", "passed", "failed", "untested"])
        self.assertEqual(rows[3], ["./dev build, minutes", "9.1", "8.0", "-"])
        self.assertEqual(len({len(line) for line in text.splitlines()}), 1)


class Mirrors(unittest.TestCase):
    def setUp(self):
        patched = mock.patch.dict(os.environ)
        patched.start()
        self.addCleanup(patched.stop)
        os.environ.pop("DVI_MIRROR_DEBIAN", None)
        os.environ.pop("DVI_MIRROR_UBUNTU", None)

    def test_the_first_mirror_of_apt_with_the_distribution_is_used(self):
        self.assertEqual(systems.mirror_of("Debian", TARGETS), "http://mirror.example/debian")

    def test_a_distribution_that_apt_does_not_use_has_the_default_of_debootstrap(self):
        self.assertEqual(systems.mirror_of("Ubuntu", TARGETS), "")

    def test_the_environment_replaces_the_mirror(self):
        os.environ["DVI_MIRROR_UBUNTU"] = "http://other.example/ubuntu"
        self.assertEqual(systems.mirror_of("Ubuntu", TARGETS), "http://other.example/ubuntu")


class Bootstrap(unittest.TestCase):
    def bootstrap(self, script):
        """Runs it with another debootstrap, a shell script, in a temporary folder."""
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "debootstrap"
            program.write_text(f"#!/bin/sh\n{script}\n")
            program.chmod(0o755)
            with mock.patch.dict(os.environ, {"PATH": f"{folder}:{os.environ['PATH']}", "DVI_MIRROR_DEBIAN": "http://m.example"}):
                systems.bootstrap(systems.SYSTEMS["debian13"], Path(folder) / "base", Path(folder) / "cache", Path("keys"),
                                  Path(folder) / "log")
            return (Path(folder) / "log").read_text()

    def test_suite_mirror_and_script_are_given(self):
        self.assertTrue(self.bootstrap('echo "$@"').endswith("base http://m.example sid\n"))

    def test_a_mirror_that_does_not_answer_is_the_reason_why_it_is_untested(self):
        with self.assertRaisesRegex(systems.Unreachable, "Failed getting release file http://m.example"):
            self.bootstrap('echo "E: Failed getting release file http://m.example/dists/trixie/Release"; exit 1')

    def test_another_error_is_a_failure(self):
        with self.assertRaisesRegex(RuntimeError, "debootstrap failed with 3"):
            self.bootstrap('echo "E: no space left"; exit 3')

    def test_a_system_without_keys_is_untested(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(systems.Unreachable, "ubuntu-archive-keyring.gpg"):
            systems.keyring_of(systems.SYSTEMS["ubuntu24.04"], [Path(folder)])


if __name__ == "__main__":
    unittest.main()
