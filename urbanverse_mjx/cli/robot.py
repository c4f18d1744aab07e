"""`urbanverse robot`: prints a robot's description and how well spheres fit its collision shapes."""

import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Annotated, Any

import tyro

from ..datatypes import validation as v
from ._options import parse


@dataclasses.dataclass(frozen=True)
class RobotArgs:
    """Read a robot; prints a line for each collision shape that is replaced by spheres, with the largest error of the
    fit, the robot's stance, whether it falls over when it starts or stops, and one JSON line."""

    source: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="NAME|PATH")]
    """A robot.json, its folder, wheelchair, or a robot of docs/robots.md, such as courier."""
    picture: pathlib.Path | None = None
    """PNG file to write, with the shapes and spheres from three sides."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse robot`."""
    args = parse(RobotArgs, argv, "urbanverse robot")
    from ..robots.description import load_with_fits
    from ..robots.stance import stance
    from ..robots.start import start, weaker_motors

    robot, fits = load_with_fits(args.source)
    for fit in fits:
        name = fit.geom or f"(a geom of {fit.body})"
        what = f"{fit.shape}{', rolls' if fit.rolls else ''}"
        number = f"{len(fit.spheres):>3} {'sphere' if len(fit.spheres) == 1 else 'spheres'},"
        errors = f"largest protrusion {fit.cover.protrudes:.3f} m, largest gap {fit.cover.falls_short:.3f} m"
        sys.stdout.write(f"{name:<24} {what:<16} {number:<12} {errors}\n")
    for fit in fits:
        if fit.misses:
            sys.stdout.write(f"{fit.geom or f'(a geom of {fit.body})'}: {_remedy(fit)}\n")
    wheels = [fit.cover.protrudes for fit in fits if fit.rolls]
    if wheels:
        sys.stdout.write(
            "wheels: their spheres have the wheel's radius, so that it rolls smoothly, and protrude to the sides, up "
            f"to {max(wheels):.3f} m; this is no error of the fit, but beside obstacles the robot is wider by it where "
            "no other part reaches as far\n"
        )
    stands = stance(robot)
    if stands.clearance is not None:
        sys.stdout.write(f"lowest part that is no foot: {stands.clearance:.3f} m above the ground\n")
    place = f"{abs(stands.margin):.3f} m {'outside' if stands.margin < 0 else 'inside'} the feet"
    tips = f"tips over at {stands.tips_at:.1f} m/s²"
    sys.stdout.write(f"centre of mass: {place}, {stands.height:.3f} m high; {tips}\n")
    starts = start(robot)
    weaker = weaker_motors(robot) if starts is not None and starts.touches and starts.after else None
    if starts is not None:
        sys.stdout.write(
            f"full speed from rest on level ground, then a stop: {_outcome(starts, weaker, stands.margin, robot)}\n"
        )
    if args.picture is not None:
        _draw(args.picture, robot, fits)
    worst = max((fit.cover.error for fit in fits), default=0.0)
    said: dict[str, Any] = {"robot": robot.name, "fitted": len(fits), "largest_error": round(worst, 4)}
    said |= {"spawn_height": round(robot.spawn_height, 4), "circumradius": round(robot.circumradius, 4)}
    said |= {"clearance": stands.clearance and round(stands.clearance, 4), "tips_at": round(stands.tips_at, 2)}
    if starts is not None:
        said |= {"start_touches": starts.touches, "start_after": starts.after and round(starts.after, 4)}
        said |= {"start_speed": round(starts.speed, 3), "start_gain": weaker and weaker.share}
    print(json.dumps(said | {"feet": list(robot.foot_geoms)}))
    return 0


def _remedy(fit: Any) -> str:
    from ..robots.sphere_fit import MOST_SPHERES

    options = fit.options
    found = (
        f"the error, {fit.cover.error:.3f} m, is above fit.tolerance ({options.tolerance:g} m) with at most "
        f"{options.spheres} spheres: the robot touches obstacles up to that much too early or too late"
    )
    if options.spheres >= MOST_SPHERES:
        return f"{found}; to come closer, make it of several smaller shapes"
    return f'{found}; to come closer, write "fit": {{"spheres": {MOST_SPHERES}}} or make it of several smaller shapes'


def _outcome(starts: Any, weaker: Any, margin: float, robot: Any) -> str:
    from ..robots.start import DRIVING_TIME, MIN_SPEED_SHARE

    if starts.touches is None:
        speed = f"only its feet touch the ground, it drives at {starts.speed:.2f} m/s"
        if MIN_SPEED_SHARE * robot.max_speed <= starts.speed <= robot.max_speed / MIN_SPEED_SHARE:
            return speed
        return (
            f"{speed} and not at its max_speed, {robot.max_speed:.2f} m/s; compare each motor's gain (gainprm) with "
            "the damping of its joint, which should be equal, and wheel_radius with the wheel's"
        )
    if not starts.after and margin < 0:
        return f"{starts.touches} touches the ground at rest: move the centre of mass inside the feet"
    if not starts.after:
        return f"{starts.touches} touches the ground at rest; raise it, or name it as one of the feet"
    when = (
        f"{starts.after:.2f} s"
        if starts.after < DRIVING_TIME
        else f"the command to stop by {starts.after - DRIVING_TIME:.2f} s"
    )
    falls = f"{starts.touches} touches the ground after {when}: the motors tip the robot over; "
    move = "move the centre of mass farther inside the feet"
    if weaker is None:
        return f"{falls}{move} (motors of a half to a 32nd of their gain do not help)"
    damping = "" if weaker.damping is None else f' and damping="{weaker.damping:g}" of its joint'
    return (
        f'{falls}with {weaker.share:g} times their gain (gainprm="{weaker.gain:g}"{damping}) it stays on its feet and '
        f"drives at {weaker.start.speed:.2f} m/s; or {move}"
    )


def _draw(path: pathlib.Path, robot: Any, fits: Any) -> None:
    from PIL import Image

    from ..viz.robot_shapes import robot_shapes

    image = Image.fromarray(robot_shapes(robot, fits))
    v.write_atomically(path, lambda p: image.save(p, "PNG"))
