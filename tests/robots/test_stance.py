"""How a robot stands, compared with numbers by hand and with C MuJoCo."""

import json
import pathlib
import re

import mujoco
import numpy as np
import pytest

from urbanverse_mjx.cli.main import main
from urbanverse_mjx.robots.description import load
from urbanverse_mjx.robots.stance import stance
from urbanverse_mjx.robots.start import DRIVING_TIME, start, weaker_motors

#: Two wheels behind and a caster in front; the centre of mass 0.05 m before the wheels and 0.3 m above the ground.
BODY = """
  <body name="base" pos="0 0 0.1">
    <freejoint/>
    <inertial pos="{x} 0 0.2" mass="10" diaginertia="0.2 0.2 0.2"/>
    <camera name="front" pos="0.3 0 0.1"/>
    <geom name="left" size="0.1" pos="0 0.2 0" friction="2 0.005 0.0001"/>
    <geom name="right" size="0.1" pos="0 -0.2 0" friction="2 0.005 0.0001"/>
    <geom name="caster" size="0.1" pos="0.3 0 0" friction="2 0.005 0.0001"/>
    <geom name="belly" size="0.05" pos="0.1 0 {z}"/>
  </body>"""


def written(folder: pathlib.Path, x: float = 0.05, z: float = 0.02) -> pathlib.Path:
    options = '<option integrator="Euler" cone="pyramidal" timestep="0.005"/>'
    body = BODY.format(x=x, z=z)
    (folder / "r.xml").write_text(f"<mujoco>{options}<worldbody>{body}</worldbody></mujoco>")
    limits = {"max_speed": 1.0, "max_yaw_rate": 1.0, "planner": {"radius": 0.4, "height": 0.5, "step": 0.02}}
    said = {"schema": "urbanverse.robot/1", "name": "r", "mjcf": "r.xml", "root_body": "base", "camera": "front"}
    said |= {"feet": ["left", "right", "caster"], "drive": {"kind": "gait"}, **limits}
    (folder / "robot.json").write_text(json.dumps(said))
    return folder


def test_numbers_by_hand(tmp_path: pathlib.Path) -> None:
    found = stance(load(written(tmp_path)))
    assert (found.clearance, found.margin, found.height) == pytest.approx((0.07, 0.05, 0.3))
    assert found.tips_at == pytest.approx(9.81 * 0.05 / 0.3)
    # Beside the front edge from (0, 0.2) to (0.3, 0), which is nearer than the axle.
    found = stance(load(written(tmp_path, x=0.25)))
    assert found.margin == pytest.approx((0.6 - 2 * 0.25) / 13**0.5)
    found = stance(load(written(tmp_path, x=-0.02, z=-0.06)))
    assert (found.clearance, found.margin, found.tips_at) == pytest.approx((-0.01, -0.02, 0.0))


@pytest.mark.parametrize(("share", "tips"), [(0.9, False), (1.1, True)])
def test_mujoco_tips_the_robot_over_at_that_acceleration(share: float, tips: bool, tmp_path: pathlib.Path) -> None:
    """An acceleration forwards is a gravity that pulls backwards."""
    backwards = share * stance(load(written(tmp_path))).tips_at
    floor = '<geom type="plane" size="5 5 1" friction="2 0.005 0.0001"/>'
    body = BODY.format(x=0.05, z=0.02)
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{floor}{body}</worldbody></mujoco>")
    model.opt.gravity[:] = -backwards, 0.0, -9.81
    data = mujoco.MjData(model)
    for _ in range(1000):
        mujoco.mj_step(model, data)
    up = data.xmat[1].reshape(3, 3)[2, 2]
    assert (up < np.cos(0.3)) == tips


def test_the_command_says_it(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robot", str(written(tmp_path))]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "lowest part that is no foot: 0.070 m above the ground"
    assert lines[1].endswith("tips over at 1.6 m/s²")
    said = json.loads(lines[-1])
    assert (said["clearance"], said["tips_at"]) == (0.07, 1.64)


def rover(
    folder: pathlib.Path, gain: float, centre: float = 0.05, drop: float = 0.0, ahead: int = 1, kv: bool = False
) -> pathlib.Path:
    """Two driven wheels, a caster in front (`ahead` = -1: behind) and a bumper opposite, on which the robot falls.

    Its servos are a gain against the joint's damping, or velocity actuators.
    """
    damping = 0.0 if kv else gain
    servo = (
        '<velocity name="{0}m" joint="{0}j" kv="{1:g}"/>'
        if kv
        else '<general name="{0}m" joint="{0}j" gainprm="{1:g}"/>'
    )
    (folder / "r.xml").write_text(f"""
<mujoco>
  <option integrator="Euler" cone="pyramidal" timestep="0.005"/>
  <worldbody>
    <body name="base" pos="0 0 0.11">
      <freejoint/>
      <inertial pos="{ahead * centre} 0 0.02" mass="18" diaginertia="0.3 0.5 0.6"/>
      <camera name="front" pos="0.3 0 0.25"/>
      <geom name="bumper" size="0.05" pos="{-0.25 * ahead} 0 {0.03 - drop}"/>
      <geom name="caster" size="0.05" pos="{0.22 * ahead} 0 -0.06" condim="1" priority="1"/>
      <body name="l" pos="0 0.22 0">
        <joint name="lj" axis="0 1 0" damping="{damping:g}" armature="0.02"/>
        <geom name="left" size="0.11" mass="1"/>
      </body>
      <body name="r" pos="0 -0.22 0">
        <joint name="rj" axis="0 1 0" damping="{damping:g}" armature="0.02"/>
        <geom name="right" size="0.11" mass="1"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    {servo.format("l", gain)}
    {servo.format("r", gain)}
  </actuator>
</mujoco>""")
    drive = {"kind": "differential", "left": ["lm"], "right": ["rm"], "wheel_radius": 0.11, "track": 0.44}
    said = {"schema": "urbanverse.robot/1", "name": "r", "mjcf": "r.xml", "root_body": "base", "camera": "front"}
    said |= {"feet": ["left", "right", "caster"], "max_speed": 1.2, "max_yaw_rate": 1.0, "drive": drive}
    said |= {"planner": {"radius": 0.4, "height": 0.5, "step": 0.02}}
    (folder / "robot.json").write_text(json.dumps(said))
    return folder


def test_strong_motors_tip_a_robot_over_that_weak_ones_do_not(tmp_path: pathlib.Path) -> None:
    """Both have the same stance; what differs is the acceleration that their motors give."""
    assert stance(load(rover(tmp_path, 2.0))).tips_at == stance(load(rover(tmp_path, 1.0))).tips_at
    strong = start(load(rover(tmp_path, 2.0)))
    assert strong is not None
    assert strong.touches == "bumper"
    assert strong.after is not None
    assert 0.05 < strong.after < 1.0
    for gain, centre in ((1.0, 0.05), (2.0, 0.08)):
        weak = start(load(rover(tmp_path, gain, centre)))
        assert weak is not None
        assert (weak.touches, weak.after) == (None, None), (gain, centre)
        assert weak.speed == pytest.approx(1.2, abs=0.02)
    low = start(load(rover(tmp_path, 1.0, drop=0.12)))
    assert (low and low.touches, low and low.after) == ("bumper", 0.0)
    assert start(load(written(tmp_path))) is None, "a robot with a gait does not start by its wheels"


def test_a_robot_that_falls_on_its_nose_does_so_when_it_stops(tmp_path: pathlib.Path) -> None:
    found = start(load(rover(tmp_path, 2.0, ahead=-1)))
    assert found is not None
    assert found.touches == "bumper"
    assert found.after is not None
    assert DRIVING_TIME < found.after < DRIVING_TIME + 1.0
    assert found.speed == pytest.approx(1.2, abs=0.02)


@pytest.mark.parametrize("kv", [False, True])
@pytest.mark.parametrize(("gain", "share"), [(2.0, 1 / 2), (5.0, 1 / 4)])
def test_the_weaker_motors_that_are_named_hold_when_they_are_written_down(
    gain: float, share: float, kv: bool, tmp_path: pathlib.Path
) -> None:
    weaker = weaker_motors(load(rover(tmp_path, gain, kv=kv)))
    assert weaker is not None
    assert (weaker.share, weaker.gain) == (share, gain * share)
    assert weaker.damping == (None if kv else weaker.gain)
    again = start(load(rover(tmp_path, weaker.gain, kv=kv)))
    assert again is not None
    assert again.touches is None
    assert again.speed == pytest.approx(weaker.start.speed)
    stronger = start(load(rover(tmp_path, 2.0 * weaker.gain, kv=kv)))
    assert stronger is not None
    assert stronger.touches == "bumper"


def test_motors_too_weak_to_drive_are_no_help(tmp_path: pathlib.Path) -> None:
    """With the centre of mass over the axle any start that is worth the name tips the robot over."""
    assert weaker_motors(load(rover(tmp_path, 2.0, centre=0.002))) is None


def test_the_command_says_that_it_cannot_stand(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A part other than a foot is on the ground at rest, because of the centre of mass and not for its height."""
    assert main(["robot", str(rover(tmp_path, 2.0, centre=-0.05))]) == 0
    out = capsys.readouterr().out
    assert "m outside the feet" in out
    assert "bumper touches the ground at rest: move the centre of mass inside the feet" in out


def test_the_command_says_that_it_falls_over(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robot", str(rover(tmp_path, 2.0))]) == 0
    out = capsys.readouterr().out
    assert re.search(r"bumper touches the ground after 0\.\d\d s: the motors tip the robot over; with 0.5 times", out)
    assert '(gainprm="1" and damping="1" of its joint) it stays on its feet and drives at 1.' in out
    said = json.loads(out.splitlines()[-1])
    assert (said["start_touches"], said["start_gain"]) == ("bumper", 0.5)
    assert main(["robot", str(rover(tmp_path, 2.0, ahead=-1))]) == 0
    assert re.search(r"bumper touches the ground after the command to stop by 0\.\d\d s", capsys.readouterr().out)
    assert main(["robot", "wheelchair"]) == 0
    out = capsys.readouterr().out
    assert "only its feet touch the ground, it drives at 1.00 m/s" in out
    assert json.loads(out.splitlines()[-1])["start_touches"] is None


def test_the_command_says_that_its_speed_is_not_the_described_one(
    tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A servo whose gain is twice the damping of its joint turns its wheel twice as fast as it is commanded."""
    folder = rover(tmp_path, 0.5)
    for damping, ending in ((0.5, r"\d m/s$"), (0.25, r"2\.\d\d m/s and not at its max_speed, 1\.20 m/s; compare .*")):
        file = folder / "r.xml"
        file.write_text(file.read_text().replace('damping="0.5"', f'damping="{damping:g}"'))
        assert main(["robot", str(folder)]) == 0
        (line,) = (line for line in capsys.readouterr().out.splitlines() if "only its feet" in line)
        assert re.search(ending, line)
