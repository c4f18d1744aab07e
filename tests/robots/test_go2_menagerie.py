"""The Go2 from a folder laid out as Menagerie's: its masses, limits and meshes, our spheres and servos."""

import pathlib

import mujoco
import numpy as np
import pytest

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.robots import go2_body, make_go2
from urbanverse_mjx.simulation.physics_model import make_physics_model

TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def _leg(leg: str) -> str:
    x, y = (0.2 if leg[0] == "F" else -0.2), (0.05 if leg[1] == "L" else -0.05)
    out = ""
    for link, place in (("hip", f"{x} {y} 0"), ("thigh", f"0 {2 * y} 0"), ("calf", "0 0 -0.21")):
        out += (
            f'<body name="{leg}_{link}" pos="{place}">'
            '<inertial pos="0 0 -0.1" mass="1.5" diaginertia="2e-3 2e-3 1e-3"/>'
            f'<joint name="{leg}_{link}_joint" class="{link}"/><geom class="visual" mesh="part" material="metal"/>'
        )
    return out + f'<geom name="{leg}" class="foot"/></body></body></body>'


def _write(folder: pathlib.Path, legs: tuple[str, ...] = ("FL", "FR", "RL", "RR")) -> pathlib.Path:
    """A model with Menagerie's names, classes and order of motors, and other numbers."""
    (folder / "assets").mkdir(parents=True)
    (folder / "assets" / "part.obj").write_text(TETRAHEDRON)
    motors = "".join(
        f'<motor class="{j}" name="{leg}_{j}" joint="{leg}_{j}_joint"/>'
        for leg in sorted(legs, reverse=True)
        for j in go2_body.JOINTS
    )
    (folder / "go2.xml").write_text(f"""<mujoco model="go2">
  <compiler angle="radian" meshdir="assets" autolimits="true"/>
  <option cone="elliptic" impratio="100"/>
  <default>
    <joint axis="0 1 0" damping="2" armature="0.015" frictionloss="0.2"/>
    <default class="hip"><joint axis="1 0 0" range="-1 1"/><motor ctrlrange="-20 20"/></default>
    <default class="thigh"><joint range="-1.5 3.4"/><motor ctrlrange="-20 20"/></default>
    <default class="calf"><joint range="-2.7 -0.8"/><motor ctrlrange="-40 40"/></default>
    <default class="visual"><geom type="mesh" contype="0" conaffinity="0" group="2"/></default>
    <default class="foot"><geom size="0.022" pos="0 0 -0.213" condim="6"/></default>
  </default>
  <asset><material name="metal" rgba=".9 .95 .95 1"/><mesh file="part.obj"/></asset>
  <worldbody>
    <body name="base" pos="0 0 0.445"><inertial pos="0.02 0 0" mass="7" diaginertia="0.1 0.1 0.03"/><freejoint/>
      <geom class="visual" mesh="part" material="metal" pos="0 0 0.02"/><geom type="box" size="0.19 0.05 0.06"/>
      {"".join(map(_leg, legs))}
    </body>
  </worldbody>
  <actuator>{motors}</actuator>
</mujoco>""")
    return folder


def test_numbers_and_meshes_are_theirs(tmp_path: pathlib.Path) -> None:
    robot = make_go2(_write(tmp_path / "unitree_go2"))
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    assert model.body_subtreemass[0] == pytest.approx(7.0 + 12 * 1.5)
    np.testing.assert_allclose(model.body("base").ipos, [0.02, 0, 0])
    np.testing.assert_allclose(sorted(model.body("FL_calf").inertia), [1e-3, 2e-3, 2e-3])
    np.testing.assert_allclose(model.body("RR_thigh").pos, [0, -0.1, 0])
    np.testing.assert_allclose(model.joint("RL_thigh_joint").range, [-1.5, 3.4])
    np.testing.assert_allclose(model.dof_armature[6:], 0.015)
    # Motors in our order, whatever theirs is.
    names = [model.joint(j).name for j in model.actuator_trnid[:, 0]]
    assert tuple(names) == go2_body.JOINT_NAMES
    np.testing.assert_allclose(model.actuator_forcerange, np.tile([[-20, 20], [-20, 20], [-40, 40]], (4, 1)))
    seen = [g for g in range(model.ngeom) if model.geom_contype[g] == 0 and model.geom_conaffinity[g] == 0]
    assert [model.geom_type[g] for g in seen] == [mujoco.mjtGeom.mjGEOM_MESH] * 13
    assert model.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL


def test_the_rest_is_ours_and_engines_take_it(tmp_path: pathlib.Path) -> None:
    found = make_physics_model(make_go2(_write(tmp_path / "unitree_go2")))
    own = make_physics_model(make_go2())
    assert found.spheres.name == own.spheres.name
    np.testing.assert_allclose(found.spheres.radius, own.spheres.radius)
    np.testing.assert_allclose(found.model.dof_damping, own.model.dof_damping)
    np.testing.assert_allclose(found.model.actuator_gainprm, own.model.actuator_gainprm)
    np.testing.assert_allclose(found.model.key_qpos, own.model.key_qpos)
    assert (found.model.dof_frictionloss == 0).all()


def test_what_is_no_go2_is_refused(tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match=r"no go2\.xml"):
        make_go2(tmp_path)
    with pytest.raises(ValidationError, match="RR_hip"):
        make_go2(_write(tmp_path / "three", ("FL", "FR", "RL")))
    broken = _write(tmp_path / "broken")
    (broken / "assets" / "part.obj").unlink()
    with pytest.raises(ValidationError, match="does not read"):
        make_go2(broken)
