"""The physics model: the robot alone, with the engine's tables of its collision spheres.

In:   `RobotSpec`.
Out:  `PhysicsModel`: MuJoCo and MJX models without one hull, and constants per sphere.
When: once, at construction.

The engine computes contacts itself (`hull_contact`), so no geom of this model collides; MJX then makes no contact rows,
and the model does not depend on the scene.
"""

import dataclasses
import functools
from typing import Any

import jax
import mujoco
import numpy as np

from ..datatypes import RobotSpec
from ..datatypes import validation as v

#: MuJoCo's defaults for every geom of a scene: contact parameters are mixed with them.
_WORLD_SOLREF = np.array([0.02, 1.0])
_WORLD_SOLIMP = np.array([0.9, 0.95, 0.001, 0.5, 2.0])


@dataclasses.dataclass(frozen=True)
class SphereTable:
    """Constants per collision sphere, n of them.

    Attributes:
      name: (n,) names of the geoms.
      geom: (n,) geom numbers.
      body: (n,) body numbers.
      radius: (n,) m.
      foot: (n,) which of `RobotSpec.foot_geoms`, which may touch the ground, it is; -1 = none.
      friction: (n,) of the sphere.
      own_friction: (n,) bool, the sphere's counts alone (it has the higher priority), else the larger of both.
      slippery: (n,) bool, no friction at all (condim 1 counts).
      solref: (n, 2), solimp: (n, 5), mixed with the world's.
      invweight: (n,) 1/kg of the body.
      dof_mask: (n, nv) 1 where the joint moves the sphere.
    """

    name: tuple[str, ...]
    geom: np.ndarray
    body: np.ndarray
    radius: np.ndarray
    foot: np.ndarray
    friction: np.ndarray
    own_friction: np.ndarray
    slippery: np.ndarray
    solref: np.ndarray
    solimp: np.ndarray
    invweight: np.ndarray
    dof_mask: np.ndarray


@dataclasses.dataclass(frozen=True)
class LimitTable:
    """Limited hinge and slide joints, n of them.

    Attributes:
      qpos, dof: (n,) addresses.
      range: (n, 2) rad or m.
      solref: (n, 2), solimp: (n, 5), invweight: (n,).
    """

    qpos: np.ndarray
    dof: np.ndarray
    range: np.ndarray
    solref: np.ndarray
    solimp: np.ndarray
    invweight: np.ndarray


@dataclasses.dataclass(frozen=True)
class PhysicsModel:
    """A robot ready to be simulated.

    Attributes:
      spec: the robot.
      model: MuJoCo's model of the robot alone, without visual geoms.
      spheres: see `SphereTable`.
      limits: see `LimitTable`.
      root: number of the free body.
    """

    spec: RobotSpec
    model: mujoco.MjModel
    spheres: SphereTable
    limits: LimitTable
    root: int

    @functools.cached_property
    def mjx_model(self) -> Any:
        """`model` for MJX, which only the jax engine needs."""
        from mujoco import mjx

        # The first use may be inside a trace, whose values must not stay in the cache.
        with jax.ensure_compile_time_eval():
            return mjx.put_model(self.model)


def bare_robot(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """Removes parts without effect on the dynamics and disables MuJoCo's collisions."""
    for geom in list(spec.geoms):
        if geom.contype == 0 and geom.conaffinity == 0:
            spec.delete(geom)
    for objects in (spec.meshes, spec.cameras, spec.lights, spec.sites, spec.textures, spec.materials):
        for obj in list(objects):
            spec.delete(obj)
    return spec


def _check(robot: RobotSpec, model: mujoco.MjModel) -> None:
    where = f"robot {robot.name!r}"
    free = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    if len(free) != 1 or model.body(model.jnt_bodyid[free[0]]).name != robot.root_body:
        raise v.fail(f"{where}.mjcf", f"{len(free)} free joints", f"one, on the body {robot.root_body!r}")
    for g in range(model.ngeom):
        if model.geom_type[g] != mujoco.mjtGeom.mjGEOM_SPHERE:
            name = model.geom(g).name
            raise v.fail(f"{where}.mjcf: geom {name!r}", "another shape than a sphere", "collision spheres alone")
        if model.geom_condim[g] not in (1, 3):
            raise v.fail(f"{where}.mjcf: geom {model.geom(g).name!r}", f"condim {model.geom_condim[g]}", "1 or 3")
    names = {model.geom(g).name for g in range(model.ngeom)}
    for name in robot.foot_geoms:
        if name not in names:
            raise v.fail(f"{where}.foot_geoms", repr(name), "the name of a collision geom", f"one of {sorted(names)}")
    option = model.opt
    if option.integrator != mujoco.mjtIntegrator.mjINT_EULER or option.cone != mujoco.mjtCone.mjCONE_PYRAMIDAL:
        raise v.fail(f"{where}.mjcf: option", "another integrator or cone", "Euler and pyramidal")
    if option.timestep != robot.physics_timestep:
        raise v.fail(f"{where}.mjcf: timestep", f"{option.timestep:g}", f"{robot.physics_timestep:g}")


def _sphere_table(robot: RobotSpec, model: mujoco.MjModel) -> SphereTable:
    bodies = model.geom_bodyid
    mask = np.zeros((model.ngeom, model.nv))
    for g in range(model.ngeom):
        body = bodies[g]
        while body > 0:
            first, count = model.body_dofadr[body], model.body_dofnum[body]
            mask[g, first : first + max(count, 0)] = 1.0
            body = model.body_parentid[body]
    own = model.geom_priority > 0
    share = np.where(own, 1.0, model.geom_solmix / (model.geom_solmix + 1.0))[:, None]
    names = tuple(model.geom(g).name for g in range(model.ngeom))
    return SphereTable(
        name=names,
        geom=np.arange(model.ngeom),
        body=bodies.copy(),
        radius=model.geom_size[:, 0].copy(),
        foot=np.array([robot.foot_geoms.index(n) if n in robot.foot_geoms else -1 for n in names], np.int32),
        friction=model.geom_friction[:, 0].copy(),
        own_friction=own,
        # Of two geoms of equal priority the larger condim counts, and the world's is 3.
        slippery=own & (model.geom_condim == 1),
        solref=share * model.geom_solref + (1 - share) * _WORLD_SOLREF,
        solimp=share * model.geom_solimp + (1 - share) * _WORLD_SOLIMP,
        invweight=model.body_invweight0[bodies, 0].copy(),
        dof_mask=mask,
    )


def _limit_table(model: mujoco.MjModel) -> LimitTable:
    joints = np.flatnonzero(model.jnt_limited)
    dof = model.jnt_dofadr[joints]
    return LimitTable(
        qpos=model.jnt_qposadr[joints],
        dof=dof,
        range=model.jnt_range[joints].copy(),
        solref=model.jnt_solref[joints].copy(),
        solimp=model.jnt_solimp[joints].copy(),
        invweight=model.dof_invweight0[dof].copy(),
    )


def make_physics_model(robot: RobotSpec) -> PhysicsModel:
    """Compiles the robot for the engine.

    Raises:
      ValidationError: a collision geom other than a sphere, no or several free joints, an unknown foot, other options
        than Euler and pyramidal cones, or a time step that differs from the robot's.
    """
    spec = bare_robot(mujoco.MjSpec.from_string(robot.mjcf))
    model = spec.compile()
    _check(robot, model)
    spheres, limits = _sphere_table(robot, model), _limit_table(model)
    # All contacts come from the engine.
    model.geom_contype[:] = 0
    model.geom_conaffinity[:] = 0
    model.jnt_limited[:] = 0
    return PhysicsModel(robot, model, spheres, limits, int(model.body(robot.root_body).id))
