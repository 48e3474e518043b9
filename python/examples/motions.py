"""4 x 4 motions from what datasets keep."""
import numpy as np


def motion(w, x, y, z, tx, ty, tz):
    """Of a quaternion and a translation."""
    n = 2 / (w * w + x * x + y * y + z * z)
    return np.array([[1 - n * (y * y + z * z), n * (x * y - w * z), n * (x * z + w * y), tx],
                     [n * (x * y + w * z), 1 - n * (x * x + z * z), n * (y * z - w * x), ty],
                     [n * (x * z - w * y), n * (y * z + w * x), 1 - n * (x * x + y * y), tz],
                     [0, 0, 0, 1.0]])


def moved(target_from_source, points):
    """N x 3 points into the target's axes."""
    return points @ target_from_source[:3, :3].T + target_from_source[:3, 3]
