#!/usr/bin/env python3
"""The spelling check itself, on trees made for it."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent


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


if __name__ == "__main__":
    unittest.main()
