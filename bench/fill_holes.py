"""Fills the holes that `dvi export holes` writes by the inpainters of OpenCV, the benchmark's examples of other programs."""
import shutil
from pathlib import Path

import cv2
import numpy as np

RADIUS_PX = 5


def telea(image: np.ndarray, mask: np.ndarray) -> np.ndarray:
    return cv2.inpaint(image, mask, RADIUS_PX, cv2.INPAINT_TELEA)


def fsr(image: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Frequency selective reconstruction; its mask is 0 where it fills."""
    out = image.copy()
    cv2.xphoto.inpaint(image, 255 - mask, out, cv2.xphoto.INPAINT_FSR_FAST)
    return out


INPAINTERS = {"telea": telea, "fsr": fsr}


def fill_holes(holes: Path, filled: Path, inpainter: str) -> None:
    filled.mkdir()
    for file in sorted((holes / "frames").iterdir()):
        mask = cv2.imread(str(holes / "masks" / file.name), cv2.IMREAD_GRAYSCALE)
        if mask.any():
            cv2.imwrite(str(filled / file.name), INPAINTERS[inpainter](cv2.imread(str(file)), mask))
        else:
            shutil.copy(file, filled / file.name)
