"""Constants of a robot's spheres and joints against those that C MuJoCo uses for its contacts and limits."""

import types
from typing import Any

import mujoco
import numpy as np
import pytest

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.simulation import physics_model

#: A trunk with spheres of every priority and mixing, and a leg of two joints with a foot.
ROBOT = """
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 1"/>
    <body name="trunk" pos="0 0 0.1">
      <freejoint/>
      <geom name="plain" type="sphere" size="0.11" pos="0 0 0" mass="2"/>
      <geom name="mixed" type="sphere" size="0.12" pos="0.5 0 0" solmix="3" solref="0.05 0.8" mass="1"
        solimp="0.7 0.8 0.01 0.4 3" friction="0.3 0.005 0.0001"/>
      <geom name="ahead" type="sphere" size="0.13" pos="1 0 0" priority="1" solref="0.03 1.2" mass="1"
        solimp="0.6 0.9 0.02 0.3 1" friction="0.4 0.005 0.0001"/>
      <geom name="smooth" type="sphere" size="0.12" pos="1.5 0 0" priority="2" condim="1" solmix="0.5" mass="1"
        solref="0.04 0.7"/>
      <geom name="flat" type="sphere" size="0.12" pos="2 0 0" condim="1" solmix="0.25" solref="0.06 0.9" mass="1"/>
      <body name="thigh" pos="0 0.3 0">
        <joint name="hip" type="hinge" axis="0 1 0" limited="true" range="-0.5 0.7" solreflimit="0.03 0.9"/>
        <geom name="thigh" type="sphere" size="0.11" mass="0.5"/>
        <body name="shin" pos="0 0.3 0">
          <joint name="free turn" type="hinge" axis="1 0 0"/>
          <joint name="knee" type="slide" axis="0 0 1" limited="true" range="-0.1 0.2"
            solimplimit="0.5 0.6 0.01 0.5 2"/>
          <geom name="foot" type="sphere" size="0.115" solmix="9" solref="0.02 1" mass="0.25"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
FEET: Any = types.SimpleNamespace(name="made", root_body="trunk", foot_geoms=("foot", "plain"), physics_timestep=0.002)


@pytest.fixture(scope="module")
def made() -> tuple[mujoco.MjModel, mujoco.MjData, mujoco.MjModel]:
    """The robot on a floor, in contact with all spheres, and the robot without the floor."""
    whole = mujoco.MjModel.from_xml_string(ROBOT)
    data = mujoco.MjData(whole)
    mujoco.mj_forward(whole, data)
    alone = mujoco.MjSpec.from_string(ROBOT)
    alone.delete(alone.geom("floor"))
    return whole, data, alone.compile()


def test_spheres_touch_the_world_as_in_c_mujoco(made: tuple[mujoco.MjModel, mujoco.MjData, mujoco.MjModel]) -> None:
    whole, data, alone = made
    table = physics_model._sphere_table(FEET, alone)
    assert table.name == ("plain", "mixed", "ahead", "smooth", "flat", "thigh", "foot")
    assert table.foot.tolist() == [1, -1, -1, -1, -1, -1, 0]
    contacts = {whole.geom(max(c.geom)).name: c for c in data.contact}
    assert contacts.keys() == set(table.name)
    for k, name in enumerate(table.name):
        contact = contacts[name]
        np.testing.assert_allclose(table.solref[k], contact.solref, rtol=1e-6, err_msg=name)
        np.testing.assert_allclose(table.solimp[k], contact.solimp, rtol=1e-6, err_msg=name)
        assert bool(table.slippery[k]) == (contact.dim == 1)
        friction = table.friction[k] if table.own_friction[k] else max(table.friction[k], 1.0)
        assert contact.dim == 1 or friction == pytest.approx(contact.friction[0])
        assert table.radius[k] == whole.geom(name).size[0]
        body = int(whole.geom(name).bodyid[0])
        assert int(table.body[k]) == body
        assert table.invweight[k] == pytest.approx(whole.body_invweight0[body, 0])
        # A joint moves a sphere where its column of the sphere's Jacobian, or of its turn, is not 0.
        place, turn = np.zeros((3, whole.nv)), np.zeros((3, whole.nv))
        mujoco.mj_jac(whole, data, place, turn, data.geom(name).xpos, body)
        moves = (np.abs(place).sum(0) + np.abs(turn).sum(0)) > 0
        assert table.dof_mask[k].tolist() == moves.astype(float).tolist()


def test_limits_are_those_of_c_mujoco(made: tuple[mujoco.MjModel, mujoco.MjData, mujoco.MjModel]) -> None:
    whole, _, alone = made
    table = physics_model._limit_table(alone)
    joints = [whole.joint(name) for name in ("hip", "knee")]
    assert table.qpos.tolist() == [int(j.qposadr[0]) for j in joints]
    assert table.dof.tolist() == [int(j.dofadr[0]) for j in joints]
    np.testing.assert_allclose(table.range, [[-0.5, 0.7], [-0.1, 0.2]])
    np.testing.assert_allclose(table.solref, [[0.03, 0.9], [0.02, 1.0]])
    np.testing.assert_allclose(table.solimp[1], [0.5, 0.6, 0.01, 0.5, 2.0])
    np.testing.assert_allclose(table.invweight, [whole.dof_invweight0[int(j.dofadr[0])] for j in joints], rtol=1e-6)


def test_robots_that_the_engines_do_not_compute_are_refused() -> None:
    def refused(change: Any, said: str) -> None:
        spec = mujoco.MjSpec.from_string(ROBOT)
        spec.delete(spec.geom("floor"))
        change(spec)
        with pytest.raises(ValidationError, match=said):
            physics_model._check(FEET, spec.compile())

    def box(spec: mujoco.MjSpec) -> None:
        spec.geom("mixed").type = mujoco.mjtGeom.mjGEOM_BOX
        spec.geom("mixed").size = [0.1, 0.1, 0.1]

    def second(spec: mujoco.MjSpec) -> None:
        body = spec.worldbody.add_body(name="other")
        body.add_freejoint()
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0, 0])

    def renamed(spec: mujoco.MjSpec) -> None:
        spec.body("trunk").name = "root"

    def footless(spec: mujoco.MjSpec) -> None:
        spec.geom("foot").name = "toe"

    def slower(spec: mujoco.MjSpec) -> None:
        spec.option.timestep = 0.004

    def rolling(spec: mujoco.MjSpec) -> None:
        spec.geom("ahead").condim = 4

    def round_cone(spec: mujoco.MjSpec) -> None:
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC

    def implicit(spec: mujoco.MjSpec) -> None:
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST

    refused(rolling, "'ahead': found condim 4")
    refused(round_cone, "another integrator or cone")
    refused(implicit, "another integrator or cone")
    refused(box, "mixed")
    refused(second, "2 free joints")
    refused(renamed, "found 1 free joints, needed one, on the body 'trunk'")
    refused(footless, "foot")
    refused(slower, "timestep: found 0.004, needed 0.002")
