"""The published ORCA, written plainly: float64, one agent at a time, lines as a point and a direction.

Follows van den Berg, Guy, Lin and Manocha, "Reciprocal n-body collision avoidance" (2011) and the conventions of the
authors' library: what is permitted lies to the left of a line. It shares nothing with the room that it judges.
"""

import dataclasses
import math

import numpy as np

EPSILON = 1e-5


@dataclasses.dataclass
class Line:
    point: np.ndarray
    direction: np.ndarray

    def depth(self, v: np.ndarray) -> float:
        """m/s by which v lies to the right of the line."""
        return cross(self.direction, self.point - v)


def cross(a: np.ndarray, b: np.ndarray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def agent_line(
    position: np.ndarray,
    velocity: np.ndarray,
    radius: float,
    other_position: np.ndarray,
    other_velocity: np.ndarray,
    other_radius: float,
    horizon: float,
    dt: float,
    share: float = 0.5,
) -> Line:
    """The half-plane that one agent takes on towards another."""
    apart = other_position - position
    relative = velocity - other_velocity
    distance, reach = float(np.linalg.norm(apart)), radius + other_radius
    touching = distance <= reach
    time = dt if touching else horizon
    w = relative - apart / time
    length = float(np.linalg.norm(w))
    if touching or (w @ apart < 0 and (w @ apart) ** 2 > reach**2 * length**2):
        outward = w / length
        direction = np.array([outward[1], -outward[0]])
        u = (reach / time - length) * outward
    else:
        leg = math.sqrt(distance**2 - reach**2)
        # The tangent from the origin to the disc at `apart`: turn by the angle whose sine is reach / distance.
        sine, cosine = reach / distance, leg / distance
        ahead = apart / distance
        if cross(apart, w) > 0:
            direction = np.array([ahead[0] * cosine - ahead[1] * sine, ahead[0] * sine + ahead[1] * cosine])
        else:
            direction = -np.array([ahead[0] * cosine + ahead[1] * sine, -ahead[0] * sine + ahead[1] * cosine])
        u = (relative @ direction) * direction - relative
    return Line(velocity + share * u, direction)


def program1(lines: list[Line], i: int, limit: float, target: np.ndarray, is_direction: bool) -> np.ndarray | None:
    """The best point on line i under the lines before it, None where there is none."""
    line = lines[i]
    along = float(line.point @ line.direction)
    square = along**2 + limit**2 - float(line.point @ line.point)
    if square < 0:
        return None
    low, high = -along - math.sqrt(square), -along + math.sqrt(square)
    for before in lines[:i]:
        denominator = cross(line.direction, before.direction)
        numerator = cross(before.direction, line.point - before.point)
        if abs(denominator) <= EPSILON:
            if numerator < 0:
                return None
            continue
        t = numerator / denominator
        if denominator >= 0:
            high = min(high, t)
        else:
            low = max(low, t)
        if low > high:
            return None
    if is_direction:
        t = high if target @ line.direction > 0 else low
    else:
        t = min(max(float(line.direction @ (target - line.point)), low), high)
    return line.point + t * line.direction


def program2(lines: list[Line], limit: float, target: np.ndarray, is_direction: bool) -> tuple[int, np.ndarray]:
    """Lines added in turn; returns the first that could not be kept (their number where all are) and the optimum."""
    if is_direction:
        result = target * limit
    elif target @ target > limit**2:
        result = target / np.linalg.norm(target) * limit
    else:
        result = target.copy()
    for i, line in enumerate(lines):
        if line.depth(result) > 0:
            better = program1(lines, i, limit, target, is_direction)
            if better is None:
                return i, result
            result = better
    return len(lines), result


def program3(lines: list[Line], num_hard: int, begin: int, limit: float, result: np.ndarray) -> np.ndarray:
    """From line `begin` on, the point whose deepest violation of a soft line is least."""
    deepest = 0.0
    for i in range(begin, len(lines)):
        line = lines[i]
        if line.depth(result) <= deepest:
            continue
        bisectors = list(lines[:num_hard])
        for before in lines[num_hard:i]:
            determinant = cross(line.direction, before.direction)
            if abs(determinant) <= EPSILON:
                if line.direction @ before.direction > 0:
                    continue
                point = 0.5 * (line.point + before.point)
            else:
                t = cross(before.direction, line.point - before.point) / determinant
                point = line.point + t * line.direction
            direction = before.direction - line.direction
            bisectors.append(Line(point, direction / np.linalg.norm(direction)))
        inward = np.array([-line.direction[1], line.direction[0]])
        failed, better = program2(bisectors, limit, inward, True)
        if failed == len(bisectors):
            result = better
        deepest = line.depth(result)
    return result


def new_velocity(lines: list[Line], num_hard: int, limit: float, wish: np.ndarray) -> tuple[np.ndarray, bool]:
    """The velocity ORCA chooses, and whether all lines could be kept."""
    failed, result = program2(lines, limit, wish, False)
    if failed < len(lines):
        return program3(lines, num_hard, failed, limit, result), False
    return result, True
