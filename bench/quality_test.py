#!/usr/bin/env python3
"""Tests of the quality benchmark.    quality_test.py DVI"""
import contextlib
import io
import json
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import cases
import constants
import variants
from tables import cell, delta, interval, share_of, table

try:
    import numpy as np
    import page
    import pictures
    import quality
    from PIL import Image
    from scoring import Failed, Scorer, intersect, picture_names
    MISSING = ""
except ImportError as why:
    MISSING = f"{why}: ./dev bench quality installs it"

DVI = Path(sys.argv.pop()) if len(sys.argv) > 1 else None


class Tables(unittest.TestCase):
    def test_what_is_undefined_is_a_dash(self):
        self.assertEqual(cell(None), "-")
        self.assertEqual(cell(12.345), "12.35")
        self.assertEqual(delta(None, 3.0, 2), "-")
        self.assertEqual(interval({"interval": None}), "-")
        self.assertEqual(share_of(None), "-")
        self.assertEqual(share_of({"copied": {"pixels": 0}}), "-")

    def test_differences_have_a_sign_and_no_minus_zero(self):
        self.assertEqual(delta(20.5, 21.0, 2), "-0.50")
        self.assertEqual(delta(21.5, 21.0, 2), "+0.50")
        self.assertEqual(delta(20.999, 21.0, 2), "0")

    def test_markdown(self):
        self.assertEqual(table(["a", "b"], [["1", "2"]]), "| a | b |\n| --- | ---: |\n| 1 | 2 |\n")
        self.assertIn("| --- | --- |", table(["a", "b"], [], words=2))


class Variants(unittest.TestCase):
    def test_departures_from_the_paper_are_taken_back_one_by_one(self):
        ours = {"map.require_camera_visibility": True, "sample.max_frame_gap": 120, "align.points": 2000}
        published = {"map.require_camera_visibility": False, "sample.max_frame_gap": 0, "align.points": 2000}
        differing = variants.differences(ours, published)
        self.assertEqual(differing, [("map.require_camera_visibility", "true", "false"), ("sample.max_frame_gap", "120", "0")])
        switches = [("--set", "map.require_camera_visibility=false"), ("--set", "sample.max_frame_gap=0")]
        self.assertEqual([variant.arguments for variant in variants.published_switches(differing)], switches)

    def test_nothing_is_run_twice_under_two_names_nor_two_things_under_one(self):
        differing = [("stages.plane_sweep", "true", "false"), ("harmonize.unobserved_vertical", "0.1", "1.0"),
                     ("map.enabled", "true", "false"), ("depth.enabled", "true", "false")]
        self.assertEqual([variant.name for variant in variants.published_switches(differing)],
                         ["paper-map-enabled", "paper-depth-enabled"])

    def test_names_are_folders_of_their_own(self):
        names = [variant.name for variant in (*variants.METHODS, variants.AS_GIVEN, *variants.ABLATIONS)]
        self.assertEqual(len(names), len(set(names)))


class Cases(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_kitti_drives_are_found_with_their_first_frames(self):
        images = self.folder / "2011_09_26/2011_09_26_drive_0042_sync/image_02/data"
        images.mkdir(parents=True)
        for number in range(7, 40):
            (images / f"{number:010d}.png").touch()
        found = cases.find_recordings(self.folder)
        self.assertEqual([(drive.name, drive.frames) for drive in found], [("kitti-0042", "7:26")])
        self.assertEqual([case.name for case in cases.held_out(found[0]) if case.ablated], ["kitti-0042-lead"])

    def test_cases_with_mask_errors_follow_the_same_case_with_correct_masks(self):
        drive = cases.Recording("mine", self.folder, "3:9")
        street, held = cases.street_masks(), cases.held_out_masks(drive)
        self.assertEqual([case.mask_errors for case in street], 2 * ["", *cases.MASK_ERRORS])
        self.assertEqual([case.mask_errors for case in held], 4 * ["", "miss", "burst", "boxes"])
        names = [case.name for case in (*street, *held, *cases.street())]
        self.assertEqual(len(names), len(set(names)))
        self.assertEqual(held[0], cases.held_out(drive)[0])
        self.assertEqual(held[1].commands[0], (*held[0].commands[0], "--mask-errors", "miss"))
        self.assertFalse(any(case.ablated for case in (*street, *held) if case.mask_errors))

    def test_a_named_drive(self):
        drive = cases.parse_recording(f"mine={self.folder}@3:9")
        self.assertEqual((drive.name, drive.path, drive.frames), ("mine", self.folder.resolve(), "3:9"))
        for wrong in ("mine", "=x", f"a/b={self.folder}", "mine=/nowhere"):
            with self.assertRaises(ValueError, msg=wrong):
                cases.parse_recording(wrong)


@unittest.skipIf(MISSING, MISSING)
class Arguments(unittest.TestCase):
    def test_externals_are_named_folders(self):
        self.assertEqual(quality.parse_external("net=/tmp"), ("net", Path("/tmp")))
        for wrong in ("net", "dvi=/tmp", "masks as given=/tmp", "paper-x=/tmp", "net=/nowhere"):
            with self.assertRaises(ValueError, msg=wrong):
                quality.parse_external(wrong)

    def test_methods_and_ablations_are_chosen_separately(self):
        self.assertFalse(quality.parse([]).ablations)
        self.assertTrue(quality.parse(["--ablations"]).ablations)
        self.assertTrue(quality.parse(["--quick", "--constant", "PlaceParams.min_inliers=24"]).ablations)
        for wrong in (["--quick", "--ablations"], ["--ablations", "--external", "net=/tmp"]):
            with self.assertRaises(SystemExit, msg=wrong), contextlib.redirect_stderr(io.StringIO()):
                quality.parse(wrong)

    def test_the_page_names_no_folders_of_this_machine(self):
        self.assertEqual(page.shown("/a/b/drive_1: no scans"), "drive_1: no scans")
        self.assertEqual(page.shown("drive/masks"), "drive/masks")

    def test_audits_are_counted_and_failures_named(self):
        outcome = page.Outcome([], [], [], [], [], {("a", "dvi"): {"audit": ""}, ("a", "paper"): {"audit": ""}, ("a", "net"): {}}, [])
        self.assertEqual(outcome.failed_audits(), [])
        self.assertIn("2 runs, all pass", page.audited(outcome))
        outcome.results["a", "paper"]["audit"] = "color: 3 pixels"
        self.assertEqual(outcome.failed_audits(), [("a", "paper", "fails the audit: color: 3 pixels")])
        self.assertIn("**1 of 2 runs fail `dvi audit`**", page.audited(outcome))
        self.assertIn("paper on a", page.audited(outcome))

    def test_dvi_comes_first(self):
        one, two = cases.street()[2], cases.street()[-1]  # the last has a second drive
        no_fusion = next(ablation for ablation in variants.ABLATIONS if not ablation.fusion)
        rows = quality.plan([one, two], list(variants.METHODS), [variants.ABLATIONS[0], no_fusion])
        self.assertEqual([variant.name for variant in rows[0][1]][:2], ["dvi", "telea"])
        self.assertEqual([(case.short, [v.name for v in row]) for case, row in rows[2:]],
                         [(one.short, ["no-poisson"]), (two.short, ["no-poisson"]), (two.short, ["no-fusion"])])

    def test_only_dvi_runs_on_cases_with_mask_errors(self):
        correct, missed = cases.street_masks()[:2]
        rows = quality.plan([], list(variants.METHODS), [variants.ABLATIONS[0]], [correct, missed])
        self.assertEqual([(case.name, [v.name for v in row]) for case, row in rows],
                         [("street-lead", ["dvi"]), ("street-lead-miss", ["dvi", "masks as given"])])
        rows = quality.plan([correct], [variants.DVI], [], [correct, missed])
        self.assertEqual([case.name for case, _ in rows], ["street-lead", "street-lead-miss"])
        self.assertEqual(quality.choose_masked([], quick=True), [])
        self.assertEqual(quality.choose_masked([], quick=False), cases.street_masks())

    def test_incomplete_masks_are_beside_correct_ones(self):
        def figures(psnr, copied, pixels):
            return {"all": {"psnr": psnr, "pixels": pixels}, "copied": {"pixels": copied},
                    **{origin: {"pixels": 0} for origin in ("interpolated", "synthesized", "empty")}}

        def result(psnr, copied):
            return {"true_pixels": {"all": figures(psnr, copied, 200), "covered": figures(25.0, 100, 100)}}

        correct, missed = cases.street_masks()[:2]
        outcome = page.Outcome([], [], [], [], [], {}, [], [correct, missed])
        self.assertEqual(page.incomplete_masks(outcome), "")
        outcome.results.update({(correct.name, "dvi"): result(25.0, 200), (missed.name, "dvi"): result(24.0, 190),
                                (missed.name, "masks as given"): result(15.5, 100)})
        text = page.incomplete_masks(outcome)
        self.assertIn("| Synthetic street |  | correct | miss |\n", text)
        self.assertIn("| lead | dvi | 25.00 / 25.00 (100.0 %) | 24.00 / 25.00 (95.0 %) |", text)
        self.assertIn("| lead | masks as given | - | 15.50 / 25.00 (50.0 %) |", text)

    def test_masks_are_intersected(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        for name, mask in (("a", [[255, 255, 0, 0]]), ("b", [[0, 255, 255, 0]])):
            (folder / name).mkdir()
            Image.fromarray(np.array(mask, np.uint8)).save(folder / name / "0.png")
        (folder / "both").mkdir()
        intersect(folder / "a", folder / "b", folder / "both")
        self.assertEqual(np.array(Image.open(folder / "both/0.png")).tolist(), [[0, 255, 0, 0]])

    def test_ablations_without_all_their_cases_are_named_instead(self):
        one, two = cases.street()[2], cases.street()[-1]
        first, second, fusion = variants.ABLATIONS[0], variants.ABLATIONS[1], variants.ABLATIONS[-1]
        figures = {origin: {"psnr": 20.0, "ssim": 0.5} for origin in ("all", "copied")}
        results = {(case.name, name): {"evaluation": figures} for case, name in (
            (one, "dvi"), (two, "dvi"), (one, first.name), (two, first.name), (one, second.name), (two, fusion.name))}
        text = page.ablations(page.Outcome([one, two], [], [first, second, fusion], [], [], results, []))
        self.assertIn(f"| {first.name} | 0 | 0 |", text)
        self.assertIn(f"| {fusion.name} | n/a | 0 |", text)
        self.assertIn(f"left out: {second.name}.", text)
        self.assertNotIn(f"| {second.name} |", text)

    def test_crops_hold_what_weighs_most_in_their_middle(self):
        weight = np.zeros((100, 200), bool)
        weight[40:60, 90:120] = True
        self.assertEqual(pictures.densest(weight, (50, 40)), (80, 30, 130, 70))
        weight[40:60, 120:180] = True  # larger than the box
        left, top, right, bottom = pictures.densest(weight, (50, 40))
        self.assertTrue(weight[top:bottom, left:right].sum() == 20 * 50)
        self.assertEqual(pictures.densest(weight, (300, 300)), (0, 0, 200, 100))

    def test_pictures_are_of_the_median_and_the_worst_frame(self):
        frames = [{"name": name, "all": {"mae": mae, "pixels": 1}} for name, mae in (("a", 9.0), ("b", 1.0), ("c", 3.0))]
        frames.append({"name": "d", "all": {"mae": None, "pixels": 0}})
        self.assertEqual(picture_names({"per_frame": frames}), {"median": "c", "worst": "a"})


@unittest.skipIf(MISSING or not DVI, MISSING or "no program given")
class FromEndToEnd(unittest.TestCase):
    def test_a_small_street(self):
        root = Path(self.enterContext(tempfile.TemporaryDirectory()))
        case = replace(cases.street((160, 90), 4)[0], ablated=True)
        methods = [method for method in variants.METHODS if method.name in ("telea", "dvi-telea", "dvi")]
        ablations = [variants.ABLATIONS[0]]
        scorer = Scorer(DVI, root)

        def outcome():
            made = page.Outcome([case], methods, ablations, [("a.b", "1", "2")], ["net"], {}, [])
            quality.run_all(scorer, made)
            return made

        first = outcome()
        self.assertEqual(first.failures, [])
        self.assertEqual({name for _, name in first.results}, {"dvi", "dvi-telea", "telea", "no-poisson"})
        self.assertEqual(first.audits(), {("street-exact", name): "" for name in ("dvi", "dvi-telea", "telea", "no-poisson")})
        imported, ours = (first.evaluation(case, name) for name in ("dvi-telea", "dvi"))
        self.assertEqual(imported["imported"]["pixels"], ours["synthesized"]["pixels"])
        self.assertEqual(imported["copied"]["mae"], ours["copied"]["mae"])
        shown = scorer.result_folder(case, "dvi")
        self.assertTrue((shown / "report.html").exists())
        self.assertTrue((shown / "report/truth/000000.png").exists())
        times = [file.stat().st_mtime_ns for file in sorted(root.rglob("result.json"))]
        again = outcome()
        self.assertEqual(times, [file.stat().st_mtime_ns for file in sorted(root.rglob("result.json"))])
        self.assertEqual(json.dumps(list(first.results.values())), json.dumps(list(again.results.values())))

        truth = scorer.folder(case) / case.truth
        (root / "net" / case.name).mkdir(parents=True)
        for file in truth.iterdir():
            (root / "net" / case.name / file.name).write_bytes(file.read_bytes())
        quality.run_externals(scorer, again, {"net": root / "net"})
        self.assertEqual(again.failures, [])
        self.assertEqual(again.same_pixels(case, "net")["all"]["mae"], 0)

        page.write(root / "page.md", root / "images", again, scorer, "test")
        text = (root / "page.md").read_text()
        self.assertIn("**100.00 / 100.00**", text)
        self.assertIn("Provenance: 4 runs, all pass `dvi audit`", text)
        self.assertIn("| `a.b` | 1 | 2 |", text)
        self.assertIn("results/street-exact/dvi/report.html", text)
        self.assertEqual({file.name for file in (root / "images").iterdir()},
                         {"psnr.svg", "confidence.svg", "street-exact.jpg"})
        page.write_ablations(root / "ablations.md", root / "ablations", again, "test")
        text = (root / "ablations.md").read_text()
        self.assertIn("Provenance: 4 runs, all pass `dvi audit`", text)
        self.assertRegex(text, r"\| no-poisson \| [-+][0-9.]+ \|")
        self.assertIn("](ablations/psnr.svg)", text)
        self.assertEqual([file.name for file in (root / "ablations").iterdir()], ["psnr.svg"])

        scorer.call("run", "drive", "--method", "telea", "-o", root / "telea", cwd=scorer.folder(case))
        frames = root / "telea/frames"
        by_dvi = scorer.evaluate(case, scorer.result_folder(case, "dvi"), "--external", f"telea={frames}")
        self.assertEqual(scorer.beside(case, frames), by_dvi["external"]["telea"])
        self.assertEqual(again.same_pixels(case, "telea"), by_dvi["external"]["telea"])

    def test_masks_with_errors(self):
        root = Path(self.enterContext(tempfile.TemporaryDirectory()))
        correct, burst = (case for case in cases.street_masks((160, 90), 8)
                          if case.short == "lead" and case.mask_errors in ("", "burst"))
        outcome = page.Outcome([], [variants.DVI], [], [], [], {}, [], [correct, burst])
        scorer = Scorer(DVI, root)
        quality.run_all(scorer, outcome)
        self.assertEqual((outcome.failures, outcome.failed_audits()), ([], []))
        self.assertEqual(set(outcome.results), {(correct.name, "dvi"), (burst.name, "dvi"), (burst.name, "masks as given")})

        def pixels(case, name, part):
            return outcome.true_pixels(case, name)[part]["all"]["pixels"]

        self.assertEqual(pixels(correct, "dvi", "covered"), pixels(correct, "dvi", "all"))
        self.assertEqual(pixels(burst, "dvi", "all"), pixels(correct, "dvi", "all"))
        self.assertLess(pixels(burst, "dvi", "covered"), pixels(burst, "dvi", "all"))
        self.assertEqual(outcome.evaluation(burst, "dvi")["all"]["pixels"], pixels(burst, "dvi", "all"))
        as_given = outcome.true_pixels(burst, "masks as given")["all"]
        self.assertLess(page.removed_share(as_given), 1)
        self.assertLess(as_given["all"]["psnr"], outcome.true_pixels(correct, "dvi")["all"]["all"]["psnr"])
        page.write(root / "page.md", root / "images", outcome, scorer, "test")
        text = (root / "page.md").read_text()
        self.assertRegex(text, r"## Incomplete masks(.|\n)*\| lead \| masks as given \| - \| [0-9.]+ / [0-9.]+ \([0-9.]+ %\) \|")

    def test_a_changed_constant_is_an_ablation_run_by_its_own_program(self):
        root = Path(self.enterContext(tempfile.TemporaryDirectory()))
        program = root / "program"  # its constant has the effect of an option
        program.write_text(f"""#!/bin/sh
command=$1; shift
[ $command = run ] && set -- "$@" --set harmonize.poisson=false
exec "{DVI.resolve()}" $command "$@"
""")
        program.chmod(0o755)
        constant = constants.Constant("harmonize", "PoissonParams.weight", "1", "", Path("src/dvi/harmonize/poisson.h"), 1, (0, 1))
        changed = variants.changed_constant(constants.Change(constant, "0"), program)
        no_poisson = variants.ABLATIONS[0]
        case = replace(cases.street((160, 90), 4)[0], ablated=True)
        outcome = page.Outcome([case], [variants.DVI], [no_poisson, changed], [], [], {}, [])
        scorer = Scorer(DVI, root)
        quality.run_all(scorer, outcome)
        self.assertEqual((outcome.failures, outcome.failed_audits()), ([], []))
        figures = [outcome.results[case.name, variant.name]["evaluation"]["all"]["mae"]
                   for variant in (variants.DVI, no_poisson, changed)]
        self.assertEqual(figures[1], figures[2])
        self.assertNotEqual(figures[0], figures[2])
        self.assertIsNotNone(scorer.known(case, changed))
        program.write_text(program.read_text() + "# another build\n")
        self.assertIsNone(scorer.known(case, changed))
        text = page.ablations(outcome)
        self.assertIn("| harmonize::PoissonParams.weight=0 | constant `harmonize::PoissonParams.weight` = 0 instead of 1 ", text)

    def test_a_run_that_fails_its_audit_is_named_and_the_others_stay(self):
        root = Path(self.enterContext(tempfile.TemporaryDirectory()))
        forger = root / "forger"  # dvi, but for a pixel of the first frame of --method telea
        forger.write_text(f"""#!{sys.executable}
import subprocess, sys
from pathlib import Path
from PIL import Image
code = subprocess.call(["{DVI.resolve()}", *sys.argv[1:]])
if sys.argv[1] == "run" and "telea" in sys.argv:
    frame = sorted(Path(sys.argv[sys.argv.index("-o") + 1], "frames").iterdir())[0]
    image = Image.open(frame)
    image.putpixel((3, 2), tuple(255 - level for level in image.getpixel((3, 2))))
    image.save(frame)
sys.exit(code)
""")
        forger.chmod(0o755)
        case = replace(cases.street((160, 90), 4)[0], ablated=True)
        methods = [method for method in variants.METHODS if method.name in ("telea", "dvi")]
        outcome = page.Outcome([case], methods, [], [], [], {}, [])
        scorer = Scorer(forger, root)
        quality.run_all(scorer, outcome)
        self.assertEqual(outcome.failures, [])
        self.assertEqual({name for _, name in outcome.results}, {"dvi", "telea"})
        [(name, what, message)] = outcome.failed_audits()
        self.assertEqual((name, what), ("street-exact", "telea"))
        self.assertRegex(message, "outside: 1 pixels, the first in frame 0+ at 3, 2")
        page.write(root / "page.md", root / "images", outcome, scorer, "test")
        text = (root / "page.md").read_text()
        self.assertIn("**1 of 2 runs fail `dvi audit`** ([what failed](#what-failed)): telea on street-exact", text)
        self.assertIn("| street-exact | telea | fails the audit: outside: 1 pixels", text)

    def test_every_street_can_be_made(self):
        root = Path(self.enterContext(tempfile.TemporaryDirectory()))
        scorer = Scorer(DVI, root)
        for case in cases.street((160, 90), 8):
            scorer.make(case)
            for folder in (case.truth, case.ignore, *scorer.drives(case, variants.DVI)):
                self.assertTrue((scorer.folder(case) / folder).is_dir(), f"{case.name}: {folder}")

    def test_what_dvi_refuses_is_told(self):
        root = Path(self.enterContext(tempfile.TemporaryDirectory()))
        case = cases.Case("none", "none", "none", "none", (("holdout", "nowhere", "-o", "."),), "truth")
        outcome = page.Outcome([case], list(variants.METHODS), [], [], [], {}, [])
        quality.run_all(Scorer(DVI, root), outcome)
        [(name, what, message)] = outcome.failures
        self.assertEqual((name, what), ("none", "making the case"))
        self.assertIn("exit code 3", message)
        self.assertRaises(Failed, Scorer(DVI, root).call, "nonsense", cwd=root)


if __name__ == "__main__":
    unittest.main()
