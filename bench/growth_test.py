#!/usr/bin/env python3
"""The page of growth, from costs that are known; no program runs."""
import tempfile
import unittest
from pathlib import Path

try:
    import growth
    MISSING = ""
except ImportError as missing:
    MISSING = f"a package of ./dev bench growth is not installed: {missing}"

COSTS = {"read": 0.002, "fill": 0.05, "  depth": 0.02, "idle": 0.0, "CPU s per frame": 0.052, "wall s per frame": 0.03, "peak MB": 200.4,
         "MB on disk per frame": 0.123}


@unittest.skipIf(MISSING, MISSING)
class Page(unittest.TestCase):
    def test_stages_are_milliseconds_and_what_costs_nothing_is_left_out(self):
        rows = growth.rows_of({50: COSTS, 100: {**COSTS, "loops": 0.01}})
        self.assertEqual(rows[0], ["read", "2.0", "2.0"])
        self.assertEqual(rows[2], ["&nbsp;&nbsp;depth", "20.0", "20.0"])
        self.assertIn(["loops", "-", "10.0"], rows)
        self.assertIn(["**CPU ms per frame**", "52.0", "52.0"], rows)
        self.assertIn(["peak MB", "200", "200"], rows)
        self.assertIn(["MB on disk per frame", "0.12", "0.12"], rows)
        self.assertNotIn("idle", [row[0] for row in rows])
        self.assertNotIn("wall s per frame", [row[0] for row in rows])

    def test_it_is_written_with_its_plot(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "growth.md"
            growth.write_page({50: COSTS, 100: COSTS}, {1: COSTS}, "test", page)
            self.assertIn("| frames | 50 | 100 |", page.read_text(encoding="utf-8"))
            self.assertTrue((page.parent / "images/growth.svg").exists())


if __name__ == "__main__":
    unittest.main()
