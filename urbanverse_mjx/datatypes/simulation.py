"""`SimState` and the interface every engine keeps. Arrays are per env; engines work alone and under `jax.vmap`."""

from typing import Any, NamedTuple, Protocol


class Contacts(NamedTuple):
    """What touched what during the last control step.

    Attributes:
      hit: () bool, any robot geom touched an object or an agent, or a geom that is no foot touched the ground.
      hit_object: () i32, the object (visual slot) of the strongest touch, -1 = none, the ground or an agent.
      hit_ground: () bool, a geom that is no foot touched the ground.
      hit_force: () f32 N, largest normal force of such a touch over the physics steps.
      hit_fraction: () f32, share of the physics steps with such a touch.
      foot_force: (F,) f32 N, normal force on each of the robot's `foot_geoms`, the mean over the physics steps.
      hit_agent: () i32, the agent of the strongest touch of an agent, -1 = none; None where the engine has no agents.
    """

    hit: Any
    hit_object: Any
    hit_ground: Any
    hit_force: Any
    hit_fraction: Any
    foot_force: Any
    hit_agent: Any = None


class AgentShapes(NamedTuple):
    """What A agents are to a robot that runs into them: upright prisms over a disc drawn along the heading; (A,) m.

    Attributes:
      radius: of the disc. half_length: from the middle to the centre of the front disc. height: above the ground.
    """

    radius: Any
    half_length: Any
    height: Any


class AgentMotion(NamedTuple):
    """How A agents move through one control step: evenly, pushed by nothing.

    Attributes:
      position: (A, 3) m of the middle of the footprint, heading: (A,) rad, both at the beginning.
      velocity: (A, 3) m/s; turn_rate: (A,) rad/s.
      present: (A,) bool.
    """

    position: Any
    heading: Any
    velocity: Any
    turn_rate: Any
    present: Any


class Bodies(NamedTuple):
    """M things of a scene that can be pushed, wherever they are by now.

    Attributes:
      thing: (M,) i32, object (visual slot) that the body is, -1 = none.
      position: (M, 3) m, quaternion: (M, 4) wxyz: T_world_object, the frame of the bank's slots.
      velocity: (M, 3) m/s of the centre of mass; spin: (M, 3) rad/s; world frame.
      warm: (M, 6) the acceleration of velocity and spin that the solver found last.
    """

    thing: Any
    position: Any
    quaternion: Any
    velocity: Any
    spin: Any
    warm: Any


class SimState(NamedTuple):
    """State of one env between two control steps.

    Attributes:
      scene: () i32, row of the bank.
      qpos: (nq,) f32; qvel: (nv,) f32.
      xpos: (nbody, 3) f32 m, xquat: (nbody, 4) f32 wxyz: T_world_body of the robot's bodies, row 0 is the world.
      contacts: see `Contacts`.
      slot_overflow: () i32, hulls within reach that found no slot in the last step, and pairs of a robot's sphere and
        a hull that may have touched and found no place among the contacts.
      carry: whatever else the engine needs to go on, such as the solver's warm start.
      friction_scale: () f32, factor on the friction of every contact of the robot; 1 in a new state.
      mass_scale: () f32, factor on mass and inertia of every body of the robot; 1 in a new state. How softly contacts
        and joint limits give way stays that of the robot as it is described.
      bodies: see `Bodies`; None where the engine has none.
    """

    scene: Any
    qpos: Any
    qvel: Any
    xpos: Any
    xquat: Any
    contacts: Contacts
    slot_overflow: Any
    carry: Any
    friction_scale: Any
    mass_scale: Any
    bodies: Any = None


class Simulator(Protocol):
    """An engine over a bank of scenes."""

    def init(self, scene: Any, qpos: Any, qvel: Any, things: Any = None) -> SimState:
        """State at rest in the given scene with kinematics computed and no contact recorded.

        things: (M,) i32, objects that shall be bodies, -1 = none; None where the engine has no body slots.
        """
        ...

    def step(self, state: SimState, ctrl: Any, agents: AgentMotion | None = None) -> SimState:
        """One control step (`num_substeps` physics steps) with the actuator commands `ctrl` (nu,) held.

        agents: how the engine's agents move meanwhile; None if and only if it has none.
        """
        ...
