#!/usr/bin/env python3
"""Tests of the language check, on trees made for it."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

PROJECT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(PROJECT / "tools"))
import check_language  # noqa: E402


class CheckLanguage(unittest.TestCase):
    def check(self, name, text):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            done = subprocess.run([sys.executable, PROJECT / "tools/check_language.py", folder], capture_output=True, text=True)
            return done.returncode, done.stdout

    def test_british_forms_are_found_in_any_part_of_a_word(self):
        code, output = self.check("src/a.h", "int x;\nint kGreyLevels, edge_colour;\n")
        self.assertEqual(code, 1)
        self.assertIn("src/a.h:2: 'Grey': write 'gray'\nsrc/a.h:2: 'colour': write 'color'\nlanguage: 2", output)

    def test_names_of_files_are_checked(self):
        self.assertIn("src/colour.h: the name has 'colour'", self.check("src/colour.h", "")[1])

    def test_american_forms_pass(self):
        self.assertEqual(self.check("docs/a.md", "A gray meter of synthesis, labeled in color.\n")[0], 0)

    def test_names_of_others_pass(self):
        self.assertEqual(self.check("src/dvi/drive/traffic_classes.cpp", '"truck", "lorry"\n')[0], 0)
        self.assertEqual(self.check("tests/foreign/a.txt", "colour\n")[0], 0)

    def test_pictures_in_notebooks_pass(self):
        self.assertEqual(self.check("a.ipynb", '{"image/jpeg": "xKerBx", "text": "a curb"}\n')[0], 0)
        self.assertEqual(self.check("a.ipynb", '{"image/jpeg": "x", "text": "a kerb"}\n')[0], 1)

    def test_phrases_are_found_in_documents_with_their_line(self):
        code, output = self.check("docs/a.md", "# A\nNobody lends it, which\nis no mask. It takes 3 s a\nframe.\n")
        self.assertEqual(code, 1)
        for line in ("2: 'Nobody': write: no source", "2: 'lends': write: is used", "3: 'is no': write: is not a",
                     "3: 's a frame': write: per"):
            self.assertIn(f"docs/a.md:{line}", output)

    def test_phrases_across_comment_lines_are_found(self):
        hits = [(line, found) for line, _, found in check_language.phrases("a.cpp", "// A mask is\n// no image.\nint x;  // of it\n")]
        self.assertEqual(sorted(hits), [(1, "is no"), (3, "// of")])

    def test_a_comment_that_goes_on_with_of_passes(self):
        self.assertEqual(list(check_language.phrases("a.cpp", "// The size\n// of the image, and the size\n// of the mask.\n")), [])

    def test_terms_in_code_spans_and_related_wording_pass(self):
        for text in ("`dvi forecast` writes `receipt.js`.", "There is no mask.", "It is no longer used.", "Seen from above, in the same way.",
                     "The plane sweep.", "A round number.", "Understand the standard."):
            self.assertEqual(self.check("docs/a.md", text + "\n"), (0, "language: spelling and terms are as they should be\n"), text)

    def test_phrases_are_checked_in_the_listed_files_only(self):
        self.assertEqual(self.check("notes/a.txt", "Nobody lends it.\n")[0], 0)
        for name in ("src/a.cpp", "python/a.py", "tests/a.sh", "docs/algorithms/a.md", ".ci/run", "setup.py"):
            self.assertEqual(self.check(name, "Nobody lends it.\n")[0], 1, name)

    def test_names_in_code_pass_in_their_files_only(self):
        self.assertEqual(self.check("src/dvi/synth/a.cpp", "seen.t = 0;\n")[0], 0)
        self.assertEqual(self.check("src/dvi/map/a.cpp", "seen.t = 0;\n")[0], 1)

    def test_allowed_lines_pass(self):
        phrase = check_language.Phrase(r"\bwhat no\b", "a noun", (("docs/a", "exact words"),))
        with mock.patch.object(check_language, "PHRASES", (phrase,)):
            self.assertEqual([line for line, _, _ in check_language.phrases("docs/a.md", "what no one\nexact words what no\n")], [1])


if __name__ == "__main__":
    unittest.main()
