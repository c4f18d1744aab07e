"""Common base of the engines: the robot's physics model, checks of sizes, initial states."""

import warnings
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from ..datatypes import AgentMotion, AgentShapes, Bodies, Contacts, PlacedBank, RobotSpec, SceneBank, SimState
from ..datatypes import validation as v
from ..datatypes.reach_count import most_objects_in_reach, most_prisms_in_reach
from ..precision import full_precision
from . import kinematics
from .collision_slots import body_contact, body_slots
from .physics_model import make_physics_model
from .place_slots import most_in_reach

#: Coefficients of the ground: one for all of it, or those of its materials; see `engines.make_engine`.
FRICTIONS = ("uniform", "materials")
#: Pairs of a sphere and an agent that may touch at once: an agent at a flat side of COCO touches three.
AGENT_CONTACTS = 6


class Substeps(NamedTuple):
    """Records of the S physics steps of one control step.

    Attributes:
      qpos: (S, nq) after the step.
      hit: (S,) bool, see `Contacts`.
    """

    qpos: Any
    hit: Any


class EngineBase:
    """The part of an engine that is independent of the physics backend; for the arguments see the engines.

    Raises:
      ValidationError: the control period is not a multiple of the time step, there are no slots, or the bank's grids
        have a shorter reach than the robot in one control step.
    """

    def __init__(
        self,
        bank: SceneBank,
        robot: RobotSpec,
        control_dt: float,
        num_slots: int,
        num_prism_slots: int,
        agents: AgentShapes | None,
        movable: body_slots.Sizes | None = None,
        friction: str = "uniform",
    ) -> None:
        self.robot = robot
        #: Whether the ground has the friction of its materials, and the smaller of two coefficients counts.
        self.materials = v.choice(friction, "engine.friction", FRICTIONS) == "materials"
        if self.materials and not bank.knows_materials:
            warnings.warn(
                "bank: found one from before the ground had the friction of its materials, needed a newer one for "
                "friction 'materials'; build it again, or set friction to 'uniform'",
                stacklevel=3,
            )
        #: Sizes of the body slots; None where there are none.
        self.movable = body_slots.checked_sizes(movable)
        if self.movable is not None:
            self.body_table, self.body_constants = body_slots.constants(bank, self.movable)
        #: Shapes of the agent slots; None where there are none.
        self.agents = agents if agents is not None and len(agents.radius) else None
        self.physics = make_physics_model(robot)
        self.control_dt = v.number(control_dt, "engine.control_dt", above=0.0)
        self.num_substeps = round(control_dt / robot.physics_timestep)
        if abs(self.num_substeps * robot.physics_timestep - control_dt) > 1e-9 or self.num_substeps < 1:
            raise v.fail(
                "engine.control_dt", f"{control_dt:g} s", f"a multiple of the physics step {robot.physics_timestep:g} s"
            )
        self.num_slots = v.integer(num_slots, "engine.num_slots", 0)
        self.num_prism_slots = v.integer(num_prism_slots, "engine.num_prism_slots", 1)
        #: m, largest distance of a hull that the robot can touch before the next look-up.
        self.reach = robot.circumradius + robot.max_speed * control_dt
        grid_reach = float(bank.meta["grid_reach"])
        if self.reach > grid_reach + 1e-6:
            raise v.fail(
                "bank.meta.grid_reach",
                f"{grid_reach:g} m",
                f"{self.reach:g} m for {robot.name!r}",
                "pack the bank again",
            )
        asked = self.num_slots, self.num_prism_slots
        self._fit_slots(bank)
        #: Whether the streets need more slots than requested.
        self.crowded = (self.num_slots, self.num_prism_slots) != asked

    def _fit_slots(self, bank: SceneBank) -> None:
        """Adds slots until all hulls within reach of traversable ground have one."""
        if isinstance(bank, PlacedBank):
            most = most_in_reach(bank, self.reach, self.num_slots, self.num_prism_slots)
            self.num_slots, self.num_prism_slots = most
            return
        for scene in range(bank.num_scenes):
            if self.num_slots:  # 0 means no objects
                self.num_slots = most_objects_in_reach(bank, scene, self.reach, self.num_slots)
            self.num_prism_slots = most_prisms_in_reach(bank, scene, self.reach, self.num_prism_slots)

    def check_agents(self, motion: AgentMotion | None) -> None:
        """Checks that the number of agents equals the number of agent slots."""
        given, wanted = (0 if x is None else len(x[0]) for x in (motion, self.agents))
        if given != wanted:
            raise v.fail("engine.step: agents", f"{given} of them", f"as many as the engine has slots ({wanted})")

    @property
    def body_rows(self) -> np.ndarray | None:
        """(Z, N) i32, see `Simulator`."""
        return None if self.movable is None else self.body_table.row

    @property
    def num_bodies(self) -> int:
        """M, body slots of an env."""
        return 0 if self.movable is None else self.movable.bodies

    @property
    def num_agent_contacts(self) -> int:
        """Pairs of a sphere and an agent that may touch at once."""
        return 0 if self.agents is None else min(AGENT_CONTACTS, len(self.agents.radius) * self.num_spheres)

    @property
    def num_body_contacts(self) -> int:
        """Contacts of movable bodies with anything but the robot."""
        each = body_contact.GROUND_CONTACTS + body_contact.OTHER_CONTACTS
        return 0 if self.movable is None else self.movable.awake * each

    @property
    def num_spheres(self) -> int:
        return len(self.physics.spheres.radius)

    @property
    def num_pairs(self) -> int:
        """Pairs of a sphere of the robot and a slot."""
        return (self.num_slots + self.num_prism_slots) * self.num_spheres

    @full_precision
    def init(self, scene: Any, qpos: Any, qvel: Any, objects: Any = None) -> SimState:
        """State in the scene (() i32) with kinematics computed and no contact recorded; qpos (nq,), qvel (nv,).

        objects: (M,) i32, objects that become bodies, -1 = none; None for no bodies.
        """
        scene = jnp.asarray(scene, jnp.int32)
        qpos, qvel = jnp.asarray(qpos, jnp.float32), jnp.asarray(qvel, jnp.float32)
        qpos, xpos, xquat = kinematics.forward(self.physics.model, qpos)
        no, none = jnp.zeros((), bool), jnp.full((), -1, jnp.int32)
        nobody = None if self.agents is None else none
        feet = jnp.zeros(len(self.robot.foot_geoms))
        contacts = Contacts(no, none, no, jnp.zeros(()), jnp.zeros(()), feet, nobody)
        zero, one = jnp.zeros((), jnp.int32), jnp.ones(())
        warm = jnp.zeros_like(qvel)
        bodies = self._first_bodies(scene, objects)
        return SimState(scene, qpos, qvel, xpos, xquat, contacts, zero, warm, one, one, bodies)

    def _first_bodies(self, scene: Any, objects: Any) -> Bodies | None:
        wanted = self.num_bodies
        given = wanted if objects is None else len(objects)
        if given != wanted:
            raise v.fail("engine.init: objects", f"{given} of them", f"as many as the engine has body slots ({wanted})")
        if self.movable is None:
            return None
        objects = jnp.full(wanted, -1, jnp.int32) if objects is None else jnp.asarray(objects, jnp.int32)
        return body_slots.begin(self.body_constants, scene, objects)
