"""Puts hands and feet of a figure where they belong: on handlebars, pedals, tools."""

import numpy as np

from ...meshes.shapes import Point3
from .figure import FOREARM, HIP_HALF, SHANK, THIGH, UPPER_ARM, Figure


def two_links(start: np.ndarray, end: np.ndarray, lengths: tuple[float, float], bend: Point3) -> list[np.ndarray]:
    """Middle joint and end of a limb from start towards end (as far as it reaches), its joint bent towards `bend`.

    The joint lies where two spheres of the links' lengths meet (law of cosines).
    """
    first, second = lengths
    axis = end - start
    reach = min(float(np.linalg.norm(axis)), 0.998 * (first + second))
    axis = axis / np.linalg.norm(axis)
    cosine = np.clip((first**2 + reach**2 - second**2) / (2 * first * reach), -1.0, 1.0)
    aside = np.asarray(bend, float) - axis * float(np.dot(bend, axis))
    aside /= np.linalg.norm(aside)
    joint = start + first * (cosine * axis + np.sqrt(1.0 - cosine**2) * aside)
    return [joint, start + reach * axis]


def reach_hand(figure: Figure, k: int, at: Point3, bend: Point3 | None = None) -> None:
    """Hand k (0 left, 1 right) at a point; the elbow bends backwards and down by default."""
    h, side = figure.person.height, 1.0 - 2.0 * k
    aim = bend if bend is not None else (-0.4, 0.3 * side, -1.0)
    elbow, wrist = two_links(figure.shoulders[k], np.asarray(at, float), (UPPER_ARM * h, FOREARM * h), aim)
    figure.elbows[k], figure.wrists[k], figure.hands[k] = elbow, wrist, wrist


def reach_foot(figure: Figure, k: int, ankle: Point3, bend: Point3 = (1.0, 0.0, 0.35)) -> None:
    """Ankle k at a point; the knee bends forwards and up by default."""
    h, side = figure.person.height, 1.0 - 2.0 * k
    hip = figure.hip + [0, side * HIP_HALF * h, 0]
    joints = two_links(hip, np.asarray(ankle, float), (THIGH * h, SHANK * h), bend)
    figure.knees[k], figure.ankles[k] = joints
