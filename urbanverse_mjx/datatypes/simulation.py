"""`SimState` and the interfaces of engines and renderers. Arrays are per env; both work alone and under `jax.vmap`.

The shapes are annotations only, so that modules that make scenes import this module without loading JAX.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import Array, Bool, Float, Int


class Contacts(NamedTuple):
    """Contacts during the last control step.

    Attributes:
      hit: () bool, any robot geom touched an object or an agent, or a geom other than a foot touched the ground.
      hit_object: () i32, the object (visual slot) of the strongest touch, -1 = none, the ground or an agent.
      hit_ground: () bool, a geom other than a foot touched the ground.
      hit_force: () f32 N, largest normal force of such a touch over the physics steps.
      hit_fraction: () f32, share of the physics steps with such a touch.
      foot_force: (F,) f32 N, normal force on each of the robot's `foot_geoms`, the mean over the physics steps.
      hit_agent: () i32, the agent of the strongest touch of an agent, -1 = none; None where the engine has no agents.
    """

    hit: Bool[Array, ""]
    hit_object: Int[Array, ""]
    hit_ground: Bool[Array, ""]
    hit_force: Float[Array, ""]
    hit_fraction: Float[Array, ""]
    foot_force: Float[Array, " F"]
    hit_agent: Int[Array, ""] | None = None

    @property
    def only_ground(self) -> Bool[Array, ""]:
        """() bool, whether a geom other than a foot touched the ground, and no object and no agent was touched."""
        nothing_else = self.hit_ground & (self.hit_object < 0)
        return nothing_else if self.hit_agent is None else nothing_else & (self.hit_agent < 0)


class AgentShapes(NamedTuple):
    """Collision bodies of A agents: upright prisms over a disc extended along the heading; (A,) m.

    Attributes:
      radius: of the disc.
      half_length: from the middle to the centre of the front disc.
      height: above the ground.
    """

    radius: Float[np.ndarray, " A"]
    half_length: Float[np.ndarray, " A"]
    height: Float[np.ndarray, " A"]


class AgentMotion(NamedTuple):
    """The motion of A agents through one control step: linear in time, unaffected by contacts.

    Attributes:
      position: (A, 3) m of the middle of the footprint, heading: (A,) rad, both at the beginning.
      velocity: (A, 3) m/s.
      turn_rate: (A,) rad/s.
      present: (A,) bool.
    """

    position: Float[Array, "A 3"]
    heading: Float[Array, " A"]
    velocity: Float[Array, "A 3"]
    turn_rate: Float[Array, " A"]
    present: Bool[Array, " A"]


class Bodies(NamedTuple):
    """Current states of M movable objects of a scene.

    Attributes:
      object_index: (M,) i32, object (visual slot) that the body is, -1 = none.
      position: (M, 3) m, quaternion: (M, 4) wxyz: T_world_object, the frame of the bank's slots.
      velocity: (M, 3) m/s of the centre of mass.
      spin: (M, 3) rad/s; world frame.
      warm: (M, 6) the acceleration of velocity and spin that the solver found last.
    """

    object_index: Int[Array, " M"]
    position: Float[Array, "M 3"]
    quaternion: Float[Array, "M 4"]
    velocity: Float[Array, "M 3"]
    spin: Float[Array, "M 3"]
    warm: Float[Array, "M 6"]


class CameraMount(NamedTuple):
    """Offset of a robot's camera from its description.

    Attributes:
      offset: (3,) m, added to its position in the body's frame.
      rotation: (4,) wxyz, T_described_mounted.
      fovy_scale: () factor on its vertical field of view.
    """

    offset: Float[Array, " 3"]
    rotation: Float[Array, " 4"]
    fovy_scale: Float[Array, ""]


class SimState(NamedTuple):
    """State of one env between two control steps.

    Attributes:
      scene: () i32, row of the bank.
      qpos: (nq,) f32.
      qvel: (nv,) f32.
      xpos: (nbody, 3) f32 m, xquat: (nbody, 4) f32 wxyz: T_world_body of the robot's bodies, row 0 is the world.
      contacts: see `Contacts`.
      slot_overflow: () i32, hulls within reach that found no slot in the last step, and pairs of a robot's sphere and
        a hull that may have touched and found no place among the contacts.
      carry: further state of the engine, such as the solver's warm start.
      friction_scale: () f32, factor on the friction of every contact of the robot; 1 in a new state.
      mass_scale: () f32, factor on mass and inertia of every body of the robot; 1 in a new state. The softness of
        contacts and joint limits stays that of the robot's description.
      bodies: see `Bodies`; None where the engine has none.
    """

    scene: Int[Array, ""]
    qpos: Float[Array, " nq"]
    qvel: Float[Array, " nv"]
    xpos: Float[Array, "nbody 3"]
    xquat: Float[Array, "nbody 4"]
    contacts: Contacts
    slot_overflow: Int[Array, ""]
    carry: Any
    friction_scale: Float[Array, ""]
    mass_scale: Float[Array, ""]
    bodies: Bodies | None = None


@runtime_checkable
class Simulator(Protocol):
    """An engine over a bank of scenes."""

    @property
    def body_rows(self) -> Int[np.ndarray, "Z N"] | None:
        """The row of every object of every scene in the engine's table of bodies, -1 = it cannot be pushed; None where
        the engine has no body slots."""
        ...

    @property
    def num_bodies(self) -> int:
        """M, body slots of an env."""
        ...

    def init(
        self,
        scene: Int[Array, ""],
        qpos: Float[Array, " nq"],
        qvel: Float[Array, " nv"],
        objects: Int[Array, " M"] | None = None,
    ) -> SimState:
        """State at rest in the given scene with kinematics computed and no contact recorded.

        objects: (M,) i32, objects that shall be bodies, -1 = none; None where the engine has no body slots.
        """
        ...

    def step(self, state: SimState, ctrl: Float[Array, " nu"], agents: AgentMotion | None = None) -> SimState:
        """One control step (`num_substeps` physics steps) with the actuator commands `ctrl` (nu,) held.

        agents: how the engine's agents move meanwhile; None if and only if it has none.
        """
        ...


@runtime_checkable
class Renderer(Protocol):
    """Renders the image of a robot's camera in a scene of a bank."""

    def __call__(
        self,
        scene: Int[Array, ""],
        xpos: Float[Array, "nbody 3"],
        xquat: Float[Array, "nbody 4"],
        appearance_seed: Int[Array, ""] | int = 0,
        agents: AgentMotion | None = None,
        bodies: Bodies | None = None,
        mount: CameraMount | None = None,
    ) -> dict[str, Array]:
        """One frame: "rgb" (H, W, 3) u8, and "depth" (H, W) f32 m, 0 where no ray hit, of those that the renderer was
        made for.

        Args:
          scene: row of the bank.
          xpos: m, xquat: wxyz, T_world_body of the robot's bodies (`SimState`).
          appearance_seed: 0 = that of the bank; other numbers select other appearances.
          agents: their poses; None leaves them out.
          bodies: objects that moved from their places in the bank.
          mount: how the camera differs from the robot's description.
        """
        ...
