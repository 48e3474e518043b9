"""The sheets of look.py on small results."""
import os
import sys
import tempfile
import unittest
from pathlib import Path

MISSING = None
try:
    import cv2
    import numpy as np

    import look
except ImportError as missing:
    MISSING = f"a package of ./dev bench look is not installed: {missing}"

DVI = Path(sys.argv.pop()) if len(sys.argv) > 1 else Path("build/release/bin/dvi")


def write_result(folder: Path, kind: int) -> None:
    """A frame of noise with a black part in the middle, beside its drive with a truth."""
    frame = np.random.default_rng(1).integers(0, 255, (200, 300, 3), np.uint8)
    kinds = np.zeros((200, 300), np.uint8)
    kinds[80:130, 120:190] = kind
    drive = folder.parent / "drive"
    for path in (folder / "frames", folder / "kind", folder / "masks", drive / "truth"):
        path.mkdir(parents=True)
    cv2.imwrite(str(drive / "truth/a.png"), frame)
    frame[kinds > 0] = 0
    cv2.imwrite(str(folder / "frames/a.png"), frame)
    cv2.imwrite(str(folder / "kind/a.png"), kinds)
    cv2.imwrite(str(folder / "masks/a.png"), np.where(kinds > 0, 255, 0).astype(np.uint8))
    (folder / "dvi.toml").write_text(f"[job]\ntarget = '{drive}'\n")


@unittest.skipIf(MISSING, MISSING)
class Sheets(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def run_on(self, kind: int) -> list[Path]:
        write_result(self.folder / "out", kind)
        with open(os.devnull, "w") as quiet:
            stdout, sys.stdout = sys.stdout, quiet
            try:
                self.assertEqual(look.main([str(self.folder / "out"), "-o", str(self.folder / "sheets"), "--dvi", str(DVI)]), 0)
            finally:
                sys.stdout = stdout
        return list((self.folder / "sheets").iterdir())

    def test_show_the_parts_beside_the_truth(self):
        files = self.run_on(4)
        self.assertEqual([file.name for file in files], [f"{self.folder.name}-out.png"])
        sheet = cv2.imread(str(files[0]))
        width = 2 * look.CROP[0] + 6  # result, unobserved, truth
        self.assertEqual(sheet.shape, (look.LINE + 2 * look.CROP[1] + look.LINE + 8, 3 * width, 3))
        middle = (look.LINE + look.CROP[1], look.CROP[0])
        self.assertTrue((sheet[middle] == 0).all())
        self.assertTrue((sheet[:, width:2 * width] == (0, 255, 255)).all(axis=2).any(), "the outline")

    def test_leave_out_results_without_unobserved_pixels(self):
        self.assertEqual(self.run_on(1), [])

    def test_crops_stay_inside_the_image(self):
        self.assertEqual(look.limit(0, 10, 200, 480, 1000), (0, 200))
        self.assertEqual(look.limit(990, 10, 200, 480, 1000), (800, 1000))
        self.assertEqual(look.limit(100, 800, 200, 480, 1000), (260, 740))
        self.assertEqual(look.limit(3, 4, 200, 480, 50), (0, 50))


if __name__ == "__main__":
    unittest.main()
