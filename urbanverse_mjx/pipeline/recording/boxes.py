"""Boxes and captions of the objects that a frame shows, from the instance image and the poses of the step."""

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import ndimage

from ...datasets.annotations import Annotation, SeenObject, runs_of
from ...datatypes import GROUND_KINDS
from ...geometry import rotations
from .driving import Driven
from .readings import OPTICAL, camera_pose

if TYPE_CHECKING:
    from ...envs import NavEnv

#: Labels of the renderer: objects from 0 on, agents from -3 downwards.
_AGENT = -3
#: Objects in a caption, the nearest ones.
_MAX_NAMED = 5
#: Degrees to either side that are straight ahead.
_AHEAD_DEGREES = 5.0
_CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])


class Boxes:
    """Annotates frames.

    Args:
      env: whose bank names the objects.
      masks: whether to keep the masks as well.
    """

    def __init__(self, env: "NavEnv", masks: bool = False) -> None:
        self._env, self._bank, self._masks = env, env.bank, masks
        self._root = int(env.mj_model.body(env.robot.root_body).id)
        bank = env.bank
        starts = bank.mesh_vertex_start
        corners = [bank.mesh_vertices[a:b] for a, b in itertools.pairwise(starts)]
        self._lower = np.array([c.min(0) for c in corners], np.float64)
        self._upper = np.array([c.max(0) for c in corners], np.float64)
        self._categories = bank.meta["categories"]

    def annotate(self, driven: Driven, step: int, labels: np.ndarray, coverage: np.ndarray) -> Annotation:
        """The annotation of one step; labels: (H, W) "object", and coverage: (slots + agents), of the renderer."""
        steps = driven.steps
        at, turn = (
            x[0]
            for x in camera_pose(
                self._env.mj_model, self._env.robot.camera, steps.xpos[step : step + 1], steps.xquat[step : step + 1]
            )
        )
        optical = rotations.product(turn, OPTICAL)
        lowest = min(int(labels.min()), _AGENT)
        shifted = labels - lowest + 1
        counts = np.bincount(shifted.ravel())
        found, runs = [], []
        for number, place in enumerate(ndimage.find_objects(shifted), start=1):
            label = number + lowest - 1
            if place is None or label in (-1, -2):
                continue
            known = self._object(driven, step, label)
            if known is None:
                continue
            name, category, size, position, quaternion = known
            rows, columns = place
            back = optical * _CONJUGATE
            found.append(
                SeenObject(
                    label=label + 3 if label >= 0 else 2,
                    name=name,
                    category=category,
                    box=(columns.start, rows.start, columns.stop, rows.stop),
                    pixels=int(counts[number]),
                    visible=float(np.float32(counts[number] / max(coverage[self._column(label)], counts[number]))),
                    size=_numbers(size),
                    position_world=_numbers(position),
                    quaternion_world=_numbers(quaternion),
                    position_camera=_numbers(rotations.rotate(back, position - at)),
                    quaternion_camera=_numbers(rotations.product(back, quaternion)),
                )
            )
            if self._masks:
                runs.append(runs_of(labels == label))
        return Annotation(self.caption(driven, step, found), tuple(found), tuple(runs))

    def _column(self, label: int) -> int:
        """Of an object in the renderer's coverage."""
        return label if label >= 0 else self._bank.slot_mesh.shape[1] + _AGENT - label

    def _object(self, driven: Driven, step: int, label: int) -> Any:
        """Name, category, size, centre and axes of an object that is not the ground; None otherwise."""
        bank, scene, steps = self._bank, driven.scene, driven.steps
        if label <= _AGENT:
            agent, row = _AGENT - label, self._env.agent_appearances[_AGENT - label]
            mesh, category = bank.agents["mesh"][row], self._categories[bank.agents["category"][row]]
            position = np.asarray(steps.agents.position[step, agent], np.float64)
            quaternion = rotations.from_yaw(np.float64(steps.agents.heading[step, agent]))
            name = f"agent_{agent}"
        else:
            mesh, category = bank.slot_mesh[scene, label], self._categories[bank.slot_category[scene, label]]
            if category.startswith("ground:"):
                return None
            position = bank.slot_position[scene, label].astype(np.float64)
            quaternion = rotations.unit(bank.slot_quaternion[scene, label].astype(np.float64))
            name = bank.meta["object_ids"][scene][label]
            if steps.bodies is not None:
                moved = np.flatnonzero(steps.bodies.object_index[step] == label)
                if len(moved):
                    position = np.asarray(steps.bodies.position[step, moved[0]], np.float64)
                    quaternion = np.asarray(steps.bodies.quaternion[step, moved[0]], np.float64)
        lower, upper = self._lower[mesh], self._upper[mesh]
        centre = position + rotations.rotate(quaternion, 0.5 * (lower + upper))
        return name, category, upper - lower, centre, quaternion

    def caption(self, driven: Driven, step: int, seen: list[SeenObject]) -> str:
        """What the robot stands on, and the nearest objects in view with distance and direction from it."""
        position, quaternion = driven.steps.xpos[step, self._root], driven.steps.xquat[step, self._root]
        yaw = float(rotations.yaw_of(np.asarray(quaternion, np.float64)))
        parts = []
        for item in seen:
            offset = np.array(item.position_world[:2]) - position[:2]
            bearing = np.degrees((np.arctan2(offset[1], offset[0]) - yaw + np.pi) % (2 * np.pi) - np.pi)
            side = "ahead" if abs(bearing) <= _AHEAD_DEGREES else f"{abs(bearing):.0f}° to the {_side(bearing)}"
            parts.append(
                (float(np.linalg.norm(offset)), f"{spoken(item.category)} {np.linalg.norm(offset):.1f} m {side}")
            )
        named = [text for _, text in sorted(parts)[:_MAX_NAMED]]
        more = f", and {len(parts) - _MAX_NAMED} more" if len(parts) > _MAX_NAMED else ""
        view = f"In view: {', '.join(named)}{more}." if named else "No object is in view."
        ground = self._ground(driven.scene, position)
        return f"The robot is on the {ground}. {view}" if ground else view

    def _ground(self, scene: int, position: np.ndarray) -> str:
        bank = self._bank
        cell = np.floor((position[:2] - bank.map_origin[scene]) / float(bank.map_resolution)).astype(int)
        kinds = bank.map_kind[scene]
        if (cell < 0).any() or (cell >= kinds.shape).any():
            return ""
        kind = int(kinds[tuple(cell)])
        return spoken(GROUND_KINDS[kind]) if 0 < kind < len(GROUND_KINDS) else ""


def _side(bearing: float) -> str:
    return "left" if bearing > 0 else "right"


def spoken(category: str) -> str:
    """The last part of a category's name, in words."""
    return category.rpartition(":")[2].rpartition("/")[2].replace("_", " ")


def _numbers(values: Any) -> tuple[float, ...]:
    return tuple(float(x) for x in np.asarray(values, np.float32))
