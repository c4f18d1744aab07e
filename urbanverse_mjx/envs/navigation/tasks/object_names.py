"""What the objects of a compiled street are called: by class, main colour and what they stand next to.

In:   a scene of a bank. Out: its objects with their boxes on the ground, phrases that name one or several equal ones,
and vectors of these phrases. When: once per bank, on the host.
"""

import collections
import dataclasses
import zlib
from collections.abc import Sequence

import numpy as np

from ....datatypes import SceneBank
from ....datatypes.text_features import text_features
from ....geometry import rotations
from . import colours

#: Classes of people, animals and robots, the branch "street user" of the assets' ontology: they are no goals, as they
#: do not stay where they are.
STREET_USERS = frozenset(
    "bird|cat|chicken|construction worker|cow|cyclist|deer|delivery robot|delivery worker|doctor|dog|donkey|duck|"
    "elderly person|electric scooter rider|emergency worker|firefighter|gardener|hedgehog|horse|humanoid robot|infant|"
    "jogger|maintenance worker|motorcycle rider|pedestrian adult|pedestrian child|police officer|rabbit|raccoon|"
    "robot dog|roller skater|security guard|sheep|squirrel|swan|traffic controller|wheelchair user|wildlife".split("|")
)
#: m, least height and width of a goal, largest width, and largest height of its foot above the ground.
LEAST_HEIGHT, LEAST_WIDTH, MOST_WIDTH, MOST_FOOT = 0.4, 0.2, 4.0, 0.4
#: m between boxes of objects that stand next to each other.
NEXT_TO = 2.5
#: Most objects that one phrase may mean.
MOST_MEANT = 8
#: Numbers of a vector for colour and class, and for what the object stands next to.
OBJECT_SIZE, PLACE_SIZE = 96, 64
#: Numbers of a phrase's vector.
EMBEDDING_SIZE = OBJECT_SIZE + PLACE_SIZE
_RELATION = " next to "
_GROUND = "ground:"


@dataclasses.dataclass(frozen=True)
class StreetObject:
    """An object that can be a goal or a landmark.

    Attributes:
      slot: its visual slot.
      name: its class.
      colour: name of its main colour, or None if no name is clear.
      box: x, y of the centre (m), half of its length and width (m), and its heading (rad).
    """

    slot: int
    name: str
    colour: str | None
    box: tuple[float, float, float, float, float]

    @property
    def described(self) -> str:
        """Colour and class."""
        return self.name if self.colour is None else f"{self.colour} {self.name}"


@dataclasses.dataclass(frozen=True)
class Phrase:
    """A text and all objects of the street that it is true of.

    Attributes:
      text: such as "the red postbox", "a green bench", "the green bench next to the red postbox".
      name: the class.
      meant: rows of the list of objects.
    """

    text: str
    name: str
    meant: tuple[int, ...]


def objects_of(bank: SceneBank, scene: int, ground: float) -> list[StreetObject]:
    """The objects of a scene, except those that are too small, too large or above the ground.

    Args:
      ground: m, height of the pavement.
    """
    names, found = bank.meta["categories"], []
    paint: dict[int, str | None] = {}
    for slot in np.flatnonzero(bank.slot_mesh[scene] >= 0).tolist():
        name = names[bank.slot_category[scene, slot]]
        if name.startswith(_GROUND) or name in STREET_USERS:
            continue
        mesh = int(bank.slot_mesh[scene, slot])
        corners = _corners(bank, mesh)
        turn = rotations.matrix_f64(bank.slot_quaternion[scene, slot])
        world = corners @ turn.T + bank.slot_position[scene, slot]
        low, high = world[:, 2].min() - ground, world[:, 2].max() - ground
        box = _box(world[:, :2], float(np.arctan2(turn[1, 0], turn[0, 0])))
        wide = 2.0 * max(box[2:4])
        if low > MOST_FOOT or high - low < LEAST_HEIGHT or not LEAST_WIDTH <= wide <= MOST_WIDTH:
            continue
        if mesh not in paint:
            paint[mesh] = colours.main_colour(*_paint(bank, mesh))
        found.append(StreetObject(slot, name, paint[mesh], box))
    return found


def _corners(bank: SceneBank, mesh: int) -> np.ndarray:
    part = slice(int(bank.mesh_vertex_start[mesh]), int(bank.mesh_vertex_start[mesh + 1]))
    return bank.mesh_vertices[part].astype(np.float64)


def _box(points: np.ndarray, yaw: float) -> tuple[float, float, float, float, float]:
    """The box with a heading around points (n, 2) m."""
    c, s = np.cos(yaw), np.sin(yaw)
    local = points @ np.array([[c, -s], [s, c]])
    low, high = local.min(0), local.max(0)
    x, y = np.array([[c, -s], [s, c]]) @ ((low + high) / 2)
    return float(x), float(y), *((high - low) / 2).tolist(), yaw


def _paint(bank: SceneBank, mesh: int) -> tuple[np.ndarray, np.ndarray]:
    """Colours (n, 3) 0-255 of a mesh's triangles that do not face up or down, and their areas (n,)."""
    faces = bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]]
    corners = _corners(bank, mesh)[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    area = np.hypot(normal[:, 0], normal[:, 1])
    material = int(bank.mesh_material[mesh])
    texture, tint = int(bank.material_texture[material]), bank.material_rgba[material, :3].astype(np.float64)
    if texture < 0:
        return np.tile(255.0 * tint, (len(faces), 1)), area
    image = bank.texture(texture)
    uv = bank.mesh_uv[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1]][faces].mean(1)
    rows = np.floor((1.0 - uv[:, 1]) * image.shape[0]).astype(int) % image.shape[0]
    columns = np.floor(uv[:, 0] * image.shape[1]).astype(int) % image.shape[1]
    return image[rows, columns] * tint, area


def gap(a: StreetObject, b: StreetObject) -> float:
    """m between the boxes of two objects, as discs of their mean half width around points along their longer axes."""
    p, q = _axis(a), _axis(b)
    away = np.linalg.norm(p[:, None] - q, axis=-1).min()
    return float(max(away - min(a.box[2:4]) - min(b.box[2:4]), 0.0))


def _axis(o: StreetObject) -> np.ndarray:
    """(5, 2) m, points along the longer axis of an object's box."""
    x, y, a, b, yaw = o.box
    along = yaw if a >= b else yaw + np.pi / 2
    reach = np.linspace(-1.0, 1.0, 5)[:, None] * (max(a, b) - min(a, b))
    return np.array([x, y]) + reach * np.array([np.cos(along), np.sin(along)])


def phrases_of(objects: Sequence[StreetObject]) -> list[Phrase]:
    """All phrases for the objects of a scene.

    "The" stands before what is the only one of its colour and class, "a" before what is one of several; of these, those
    next to an object that is the only one of its kind are also named by it.
    """
    by_described: dict[str, list[int]] = collections.defaultdict(list)
    for i, o in enumerate(objects):
        by_described[o.described].append(i)
    for text, rows in by_described.items():
        # A class without colour is true of coloured objects of the class, too.
        rows[:] = [i for i, o in enumerate(objects) if o.name == text] or rows
    single = [rows[0] for rows in by_described.values() if len(rows) == 1]
    found = []
    for text, rows in by_described.items():
        name = objects[rows[0]].name
        if len(rows) == 1:
            found.append(Phrase(f"the {text}", name, tuple(rows)))
            continue
        if len(rows) <= MOST_MEANT:
            found.append(Phrase(f"{'an' if text[0] in 'aeiou' else 'a'} {text}", name, tuple(rows)))
        beside: dict[int, list[int]] = collections.defaultdict(list)
        for i in rows:
            for k in single:
                if objects[k].name != name and gap(objects[i], objects[k]) <= NEXT_TO:
                    beside[k].append(i)
        for k, some in beside.items():
            if len(some) == 1:
                found.append(Phrase(f"the {text}{_RELATION}the {objects[k].described}", name, tuple(some)))
    return found


def embedding(text: str) -> np.ndarray:
    """(EMBEDDING_SIZE,) f32, a vector of a phrase: of colour and class, then of what the object stands next to, each of
    length 1; 0 for none.

    The features are those of the search of assets, words and their sequences of letters, summed into a vector of fixed
    size by the sign and place that a hash gives each (Weinberger et al., "Feature Hashing for Large Scale Multitask
    Learning", 2009), which needs no vocabulary.
    """
    named, _, place = text.partition(_RELATION)
    return np.concatenate([_hashed(named, OBJECT_SIZE), _hashed(place, PLACE_SIZE)])


def _hashed(text: str, size: int) -> np.ndarray:
    words = " ".join(word for word in text.lower().split() if word not in ("the", "a", "an"))
    vector = np.zeros(size)
    for feature, weight in text_features(words).items():
        code = zlib.crc32(feature.encode())
        vector[(code >> 1) % size] += weight if code & 1 else -weight
    return (vector / max(np.linalg.norm(vector), 1e-12)).astype(np.float32)
