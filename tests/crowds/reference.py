"""The published ORCA, written plainly: float64, one agent at a time, lines as a point and a direction.

Follows van den Berg, Guy, Lin and Manocha, "Reciprocal n-body collision avoidance" (2011) and the conventions of the
authors' library: the permitted side is to the left of a line. It shares no code with the implementation under test.
"""

import dataclasses
import math

EPSILON = 1e-5


@dataclasses.dataclass(frozen=True, slots=True)
class Line:
    """Vectors of the plane are complex numbers: arrays of two would take most of the time of the tests."""

    point: complex
    direction: complex

    def depth(self, v: complex) -> float:
        """m/s by which v lies to the right of the line."""
        return cross(self.direction, self.point - v)


def dot(a: complex, b: complex) -> float:
    return a.real * b.real + a.imag * b.imag


def cross(a: complex, b: complex) -> float:
    return a.real * b.imag - a.imag * b.real


def agent_line(
    position: complex,
    velocity: complex,
    radius: float,
    other_position: complex,
    other_velocity: complex,
    other_radius: float,
    horizon: float,
    dt: float,
    share: float = 0.5,
) -> Line:
    """The half-plane that one agent takes on towards another."""
    apart = other_position - position
    relative = velocity - other_velocity
    distance, reach = abs(apart), radius + other_radius
    touching = distance <= reach
    time = dt if touching else horizon
    w = relative - apart / time
    length = abs(w)
    if touching or (dot(w, apart) < 0 and dot(w, apart) ** 2 > reach**2 * length**2):
        outward = w / length
        direction = complex(outward.imag, -outward.real)
        u = (reach / time - length) * outward
    else:
        leg = math.sqrt(distance**2 - reach**2)
        # The tangent from the origin to the disc at `apart`: turn by the angle whose sine is reach / distance.
        sine, cosine = reach / distance, leg / distance
        ahead = apart / distance
        if cross(apart, w) > 0:
            direction = complex(ahead.real * cosine - ahead.imag * sine, ahead.real * sine + ahead.imag * cosine)
        else:
            direction = -complex(ahead.real * cosine + ahead.imag * sine, -ahead.real * sine + ahead.imag * cosine)
        u = dot(relative, direction) * direction - relative
    return Line(velocity + share * u, direction)


def program1(lines: list[Line], i: int, limit: float, target: complex, is_direction: bool) -> complex | None:
    """The best point on line i under the lines before it, None where there is none."""
    line = lines[i]
    along = dot(line.point, line.direction)
    square = along**2 + limit**2 - dot(line.point, line.point)
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
        t = high if dot(target, line.direction) > 0 else low
    else:
        t = min(max(dot(line.direction, target - line.point), low), high)
    return line.point + t * line.direction


def program2(lines: list[Line], limit: float, target: complex, is_direction: bool) -> tuple[int, complex]:
    """Lines added in turn; returns the first that could not be kept (their number where all are) and the optimum."""
    if is_direction:
        result = target * limit
    elif abs(target) > limit:
        result = target / abs(target) * limit
    else:
        result = target
    for i, line in enumerate(lines):
        if line.depth(result) > 0:
            better = program1(lines, i, limit, target, is_direction)
            if better is None:
                return i, result
            result = better
    return len(lines), result


def program3(lines: list[Line], num_hard: int, begin: int, limit: float, result: complex) -> complex:
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
                if dot(line.direction, before.direction) > 0:
                    continue
                point = 0.5 * (line.point + before.point)
            else:
                t = cross(before.direction, line.point - before.point) / determinant
                point = line.point + t * line.direction
            direction = before.direction - line.direction
            bisectors.append(Line(point, direction / abs(direction)))
        inward = complex(-line.direction.imag, line.direction.real)
        failed, better = program2(bisectors, limit, inward, True)
        if failed == len(bisectors):
            result = better
        deepest = line.depth(result)
    return result


def new_velocity(lines: list[Line], num_hard: int, limit: float, preferred_velocity: complex) -> tuple[complex, bool]:
    """The velocity ORCA chooses, and whether all lines could be kept."""
    failed, result = program2(lines, limit, preferred_velocity, False)
    if failed < len(lines):
        return program3(lines, num_hard, failed, limit, result), False
    return result, True
