#!/usr/bin/env python3
"""The check of names itself, on trees made for it."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent


class CheckNames(unittest.TestCase):
    def check(self, files):
        """Runs the check on a tree of files by their paths below src/dvi."""
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                path = Path(folder) / "src/dvi" / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            done = subprocess.run(
                [sys.executable, PROJECT / "tools/check_names.py", folder], capture_output=True, text=True
            )
            return done.returncode, done.stdout

    def assert_fails(self, reason, files):
        code, output = self.check(files)
        self.assertEqual(code, 1, output)
        self.assertIn(reason, output)

    def assert_passes(self, files):
        code, output = self.check(files)
        self.assertEqual(code, 0, output)

    def test_a_module_has_its_namespace(self):
        self.assert_passes({"depth/a.h": "namespace dvi::depth {\nstruct A {};\n}\n", "core/b.h": "namespace dvi {\nstruct B {};\n}\n"})
        self.assert_passes({"depth/a.cpp": "template <>\nstruct boost::polygon::traits<int> {};\nnamespace dvi::depth {}\n"})
        self.assert_fails("src/dvi/depth/a.h:2: namespace dvi: what depth/ declares", {"depth/a.h": "\nnamespace dvi {\n}\n"})
        self.assert_fails("lies in dvi\nnames", {"core/a.h": "namespace dvi::core {\n}\n"})

    def test_a_type_is_defined_once(self):
        first = "namespace dvi::depth {\nstruct A { int x; };\n}\n"
        for second in ["class A final : public B<int> {\n};", "template <class T>\nstruct A {\n};", "enum class A : int { a };"]:
            self.assert_fails(
                "src/dvi/depth/b.h:2: A is defined a second time (the first: src/dvi/depth/a.h:2)",
                {"depth/a.h": first, "depth/b.h": "namespace dvi::depth { " + "// struct A {\n" + second.replace("\n", " ") + "\n}\n"},
            )

    def test_anonymous_namespaces_and_declarations_are_free(self):
        first = "namespace dvi::depth {\nstruct A {};\n}\n"
        for name, text in {
            "depth/a.cpp": "namespace dvi::depth {\nnamespace {\nstruct A {};\n}\n}\n",
            "depth/b.h": "namespace dvi::depth {\nstruct A;\nclass B { struct A {}; };\nA f();\nvoid g() { struct A {}; }\n}\n",
            "depth/c.h": 'namespace dvi::depth {\n// struct A {}\nconst char* s = "struct A {}";\n}\n',
        }.items():
            self.assert_passes({"depth/a.h": first, name: text})

    def test_a_name_is_used_once_in_all_modules(self):
        first = "namespace dvi::depth {\nstruct A {};\n}\n"
        self.assert_fails("src/dvi/map/b.h:2: A is defined", {"depth/a.h": first, "map/b.h": first.replace("depth", "map")})
        self.assert_fails("src/dvi/map/a.h:1: src/dvi/depth/a.h has the same name", {"depth/a.h": first, "map/a.h": ""})


if __name__ == "__main__":
    unittest.main()
