#!/usr/bin/env python3
"""The tables of costs, from the report of a run of 20 frames of 320x180."""
import copy
import json
import unittest

from cost import cost_table, costs, medians, ratio_table

REPORT = json.loads("""{
 "hole": {"pixels": 55381},
 "cost": {
  "frames_made": 20, "peak_memory_bytes": 166002688,
  "stages": [{"stage": "read", "seconds": 0.1, "cpu_seconds": 0.16}, {"stage": "map", "seconds": 0.3, "cpu_seconds": 0.34},
             {"stage": "align", "seconds": 0.5, "cpu_seconds": 0.8}, {"stage": "fill", "seconds": 2, "cpu_seconds": 2.8},
             {"stage": "video", "seconds": 0.3, "cpu_seconds": 0.3}],
  "fill": {"depth": {"cpu_seconds": 1.6}, "harmonize": {"cpu_seconds": 0.04}, "sample": {"cpu_seconds": 0.02},
           "smooth": {"cpu_seconds": 0.36}, "regularize": {"cpu_seconds": 0.32}, "write": {"cpu_seconds": 0.16}}
 }}""")


def line(table, name):
    return next(line for line in table.splitlines() if line.startswith(name))[len(name):].split()


class Costs(unittest.TestCase):
    def test_stages_stand_in_the_order_they_run(self):
        self.assertEqual(list(costs(REPORT)), [
            "read", "map", "align", "fill", "  depth", "  sample", "  regularize", "  harmonize", "  smooth", "  write", "  else",
            "video", "CPU s per frame", "wall s per frame", "peak MB", "hole, 1000 px per frame"])

    def test_are_of_one_frame(self):
        found = costs(REPORT)
        for name, value in {"align": 0.04, "  depth": 0.08, "  else": 0.015, "CPU s per frame": 0.22, "wall s per frame": 0.16,
                            "peak MB": 166.002688, "hole, 1000 px per frame": 2.76905}.items():
            self.assertAlmostEqual(found[name], value, msg=name)

    def test_no_stage_but_fill_is_counted_twice(self):
        found = costs(REPORT)
        self.assertAlmostEqual(found["CPU s per frame"], sum(found[name] for name in ["read", "map", "align", "fill", "video"]))
        self.assertAlmostEqual(found["fill"], sum(value for name, value in found.items() if name.startswith("  ")))

    def test_stages_of_completed_views_are_counted_with_those_of_the_fill(self):
        report = copy.deepcopy(REPORT)
        report["cost"]["stages"].insert(3, {"stage": "completion", "seconds": 1, "cpu_seconds": 1.2})
        report["cost"]["fill"]["depth"]["cpu_seconds"] += 1
        found = costs(report)
        self.assertAlmostEqual(found["  else"], 0.025)
        self.assertAlmostEqual(found["completion"] + found["fill"],
                               sum(value for name, value in found.items() if name.startswith("  ")))

    def test_an_unknown_stage_follows_the_known_ones(self):
        report = copy.deepcopy(REPORT)
        report["cost"]["fill"]["color"] = {"cpu_seconds": 0.2}
        names = list(costs(report))
        self.assertEqual(names[names.index("  write") + 1], "  color")

    def test_a_run_without_new_frames_is_refused(self):
        report = copy.deepcopy(REPORT)
        report["cost"]["frames_made"] = 0
        with self.assertRaises(ValueError):
            costs(report)


class Tables(unittest.TestCase):
    def test_median_of_the_runs_that_have_the_row(self):
        self.assertEqual(medians([{"a": 1, "b": 5}, {"a": 9}, {"a": 2}]), {"a": 2, "b": 5})

    def test_growth_is_last_by_first(self):
        shown = cost_table("320x180", {"20 frames": {"map": 0.02, "peak MB": 100}, "40 frames": {"map": 0.05, "peak MB": 1234.4}})
        self.assertEqual(shown.splitlines()[0].split("  "), ["320x180", "20 frames", "40 frames", "last / first"])
        self.assertEqual(line(shown, "map"), ["0.020", "0.050", "2.50"])
        self.assertEqual(line(shown, "peak MB"), ["100.0", "1234", "12.34"])

    def test_columns_are_aligned(self):
        lines = cost_table("x", {"one": {"a": 1, "long name": 22.5}}).splitlines()
        self.assertEqual(len({len(line) for line in lines}), 1, lines)

    def test_a_stage_that_cost_nothing_has_no_ratio(self):
        self.assertEqual(line(cost_table("x", {"a": {"map": 0.0}, "b": {"map": 1.0}}), "map"), ["0.000", "1.000", "-"])

    def test_ratio_is_of_medians_and_the_spread_of_single_rounds(self):
        before, after = [{"fill": 2.0}, {"fill": 4.0}, {"fill": 2.0}], [{"fill": 1.0}, {"fill": 1.0}, {"fill": 2.0}]
        self.assertEqual(line(ratio_table("x", ("old", "new"), before, after), "fill"), ["2.000", "1.000", "0.50", "0.25..1.00"])

    def test_one_round_has_no_spread(self):
        self.assertEqual(line(ratio_table("x", ("old", "new"), [{"fill": 2.0}], [{"fill": 3.0}]), "fill"), ["2.000", "3.000", "1.50"])

    def test_what_only_one_side_has_is_shown_without_ratio(self):
        shown = ratio_table("x", ("old", "new"), [{"gone": 2.0, "map": 1.0}], [{"map": 1.0, "made": 3.0}])
        self.assertEqual(line(shown, "gone"), ["2.000", "-", "-"])
        self.assertEqual(line(shown, "made"), ["-", "3.000", "-"])


if __name__ == "__main__":
    unittest.main()
