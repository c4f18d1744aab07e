"""Random views of the streets of a bank: camera poses, images and ground truth.

Within this package, only this module and the training command import the renderer, to make the perception model's
training data.
"""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np

from ...datatypes import SceneBank, ValidationError
from ...datatypes.ground import GROUND_KINDS
from ...simulation.rendering.renderer import Renderer
from . import classes
from .augment import recolour
from .targets import GroundTruth, ground_truth

HEIGHTS = (0.4, 1.8)  # m above the ground: from a delivery robot's mast to a raised hand
FIELDS_OF_VIEW = (32.0, 70.0)  # degrees, vertical: from a phone's main lens held upright to an action camera


@dataclasses.dataclass(frozen=True)
class ViewOptions:
    """Distributions of camera poses and appearances; chosen manually.

    Attributes:
      ground_shares: shares of cameras on each kind of ground: robots and people on the pavement, cyclists and cars on
        the road.
      places: camera positions per scene and kind of ground, drawn from the map's cells.
      ahead_share: share of the views along the street.
      plain_share: share of the images whose objects keep their colours. With new colours in all images, neighbouring
        houses would always differ, and the model would merge two similar ones.
      min_distance: m; a frame is blocked if the nearest fifth of its pixels is closer than this.
      targets: objects per scene that an aimed camera may look at, drawn so that rare classes are as frequent as others.
      target_distance: range of the distance between an aimed camera and its object, m.
      aim_noise: standard deviation of the direction of an aimed camera, rad.
    """

    ground_shares: tuple[tuple[str, float], ...] = (
        ("sidewalk", 0.55),
        ("crosswalk", 0.1),
        ("ground", 0.1),
        ("road", 0.25),
    )
    places: int = 1024
    ahead_share: float = 0.65
    plain_share: float = 0.5
    min_distance: float = 0.35
    targets: int = 192
    target_distance: tuple[float, float] = (2.0, 16.0)
    aim_noise: float = 0.2


_OPTIONS = ViewOptions()


@dataclasses.dataclass(frozen=True)
class Views:
    """Draws random frames of a bank with their ground truth.

    Attributes:
      places: (Z, K, places, 3) f32 m, points on the ground by scene and kind of `ground_shares`.
      weights: (Z, K) f32.
      table: (A + 1, 2) `classes.class_table` of the bank.
      heights, fields_of_view: ranges of cameras, m above the ground and degrees.
      aimed: (Z, T, 4) f32, points on the ground (m) and yaw (rad) towards an object, or (Z, 0, 4).
      aimed_share: share of the cameras that stand at a point of `aimed`.
      balance: (C,) f32 weight of an object by class, 1 on average over the objects: see `_balance`.
    """

    renderer: Renderer
    places: jax.Array
    weights: jax.Array
    table: jax.Array
    heights: tuple[float, float] = HEIGHTS
    fields_of_view: tuple[float, float] = FIELDS_OF_VIEW
    aimed: jax.Array | None = None
    aimed_share: float = 0.0
    balance: jax.Array | None = None

    @staticmethod
    def of(
        bank: SceneBank,
        height: int,
        width: int,
        appearance: float = 0.4,
        mixed: float = 0.0,
        samples: int = 2,
        seed: int = 0,
        heights: tuple[float, float] = HEIGHTS,
        fields_of_view: tuple[float, float] = FIELDS_OF_VIEW,
        aimed_share: float = 0.0,
    ) -> "Views":
        """Makes the views of a bank.

        Args:
          appearance: range of random colours and light, see `Renderer`.
          mixed: share of the roads, pavements and grounds with the material of another kind, so that the material alone
            does not identify the kind.
          samples: rays per pixel and side, as in `capture`; with one, thin objects are rendered with gaps.
          aimed_share: share of the cameras that look at an object whose class is drawn before its place.
        """
        bank = _with_mixed_ground(bank, mixed, np.random.default_rng([seed, 1]))
        renderer = Renderer(
            bank,
            None,
            height,
            width,
            ("rgb", "depth", "category", "object"),
            shadows=True,
            samples=samples,
            appearance=appearance,
        )
        places, weights = _stands(bank, np.random.default_rng(seed))
        table = classes.class_table(bank.meta["categories"])
        aimed = _aimed(bank, table, places, weights, np.random.default_rng([seed, 2])) if aimed_share > 0 else None
        return Views(
            renderer,
            *(jnp.asarray(x) for x in (places, weights, table)),
            heights=heights,
            fields_of_view=fields_of_view,
            aimed=None if aimed is None else jnp.asarray(aimed),
            aimed_share=aimed_share,
            balance=jnp.asarray(_balance(bank, table)),
        )

    def __call__(self, keys: jax.Array, dye: bool = True) -> tuple[jax.Array, GroundTruth, jax.Array]:
        """One frame per key: images (n, H, W, 3) u8, their ground truth, and (n,) 0 where the view is blocked.

        With `dye`, every object gets random colours in all but `plain_share` of the images.
        """
        scene, viewpoint, turn, fovy, number = jax.vmap(self._pose)(keys)
        dyed = dye & ~jax.vmap(lambda key: jax.random.bernoulli(jax.random.fold_in(key, 2), _OPTIONS.plain_share))(keys)
        number = jnp.where(dyed, number, 0)

        def draw(scene, viewpoint, turn, fovy, number):
            return self.renderer.view(scene, viewpoint, turn, fovy, None, None, number)

        seen = jax.vmap(draw)(scene, viewpoint, turn, fovy, number)
        focal = self.renderer.settings.height / (2.0 * jnp.tan(fovy / 2.0))
        slots = self.renderer.bank.slot_mesh.shape[1]
        wanted = jax.vmap(lambda c, o, d, f: ground_truth(c, o, d, f, self.table, slots))(
            seen["category"], seen["object"], seen["depth"], focal
        )
        depth = jnp.where(seen["category"] < 0, jnp.inf, seen["depth"])
        near = jnp.percentile(depth[:, ::8, ::8].reshape(len(keys), -1), 20.0, axis=1, method="nearest")
        images = seen["rgb"]
        if dye:
            kind = self.table[seen["category"], 0]
            region = jnp.where(kind < classes.FIRST_OBJECT, slots + kind, seen["object"])
            dyes = jax.vmap(lambda key: jax.random.fold_in(key, 1))(keys)
            anew = jax.vmap(lambda k, x, r: recolour(k, x, r, slots + classes.FIRST_OBJECT))(dyes, images, region)
            images = jnp.where(dyed[:, None, None, None], anew, images)
        return images, wanted, (near > _OPTIONS.min_distance).astype(jnp.float32)

    def _pose(self, key: jax.Array) -> tuple[jax.Array, ...]:
        """Scene, position (3,), quaternion (4,), vertical field of view and seed of its appearance."""
        keys = jax.random.split(key, 8)
        scene = jax.random.randint(keys[0], (), 0, len(self.places))
        kind = jax.random.categorical(keys[1], jnp.log(self.weights[scene]))
        place = self.places[scene, kind, jax.random.randint(keys[2], (), 0, _OPTIONS.places)]
        viewpoint = place + jnp.array([0.0, 0.0, 1.0]) * jax.random.uniform(
            keys[3], (), minval=self.heights[0], maxval=self.heights[1]
        )
        # Most views are approximately along the street (along x), like those of pedestrians; the others have any
        # direction.
        along, anywhere, noise, straight = jax.random.split(keys[4], 4)
        ahead = jnp.pi * jax.random.bernoulli(along) + 0.4 * jax.random.normal(noise)
        yaw = jnp.where(
            jax.random.bernoulli(straight, _OPTIONS.ahead_share),
            ahead,
            jax.random.uniform(anywhere, (), minval=-jnp.pi, maxval=jnp.pi),
        )
        if self.aimed is not None:
            draw, which, off = jax.random.split(jax.random.fold_in(keys[4], 1), 3)
            x, y, z, towards = self.aimed[scene, jax.random.randint(which, (), 0, self.aimed.shape[1])]
            aimed = jax.random.bernoulli(draw, self.aimed_share)
            lifted = jnp.array([x, y, z + viewpoint[2] - place[2]])
            viewpoint = jnp.where(aimed, lifted, viewpoint)
            yaw = jnp.where(aimed, towards + _OPTIONS.aim_noise * jax.random.normal(off), yaw)
        pitch, roll = jnp.radians(jnp.array([-2.0, 0.0]) + jnp.array([7.0, 2.0]) * jax.random.normal(keys[5], (2,)))
        low, high = np.radians(self.fields_of_view)
        fovy = jax.random.uniform(keys[6], (), minval=low, maxval=high)
        number = jax.random.randint(keys[7], (), 1, 2**30)
        return scene, viewpoint, camera_quaternion(yaw, pitch, roll), fovy, number


def camera_quaternion(yaw: jax.Array, pitch: jax.Array, roll: jax.Array) -> jax.Array:
    """(4,) wxyz T_world_camera of a camera that views along -z with +y up; angles in rad, pitch > 0 is upwards."""
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    ahead = jnp.array([c * jnp.cos(pitch), s * jnp.cos(pitch), jnp.sin(pitch)])
    right = jnp.array([s, -c, 0.0])
    up = jnp.cross(right, ahead)
    right, up = jnp.cos(roll) * right + jnp.sin(roll) * up, jnp.cos(roll) * up - jnp.sin(roll) * right
    return _quaternion(jnp.stack([right, up, -ahead], -1))


def _quaternion(m: jax.Array) -> jax.Array:
    """wxyz of a rotation matrix by the method of Shepperd (1978), which starts from the largest component."""
    rows = jnp.array(
        [
            [1 + m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2], m[1, 0] + m[0, 1], m[0, 2] + m[2, 0]],
            [m[0, 2] - m[2, 0], m[1, 0] + m[0, 1], 1 - m[0, 0] + m[1, 1] - m[2, 2], m[2, 1] + m[1, 2]],
            [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[2, 1] + m[1, 2], 1 - m[0, 0] - m[1, 1] + m[2, 2]],
        ]
    )
    best = rows[jnp.argmax(jnp.diagonal(rows))]
    return best / jnp.linalg.norm(best)


def _with_mixed_ground(bank: SceneBank, share: float, rng: np.random.Generator) -> SceneBank:
    """Replaces the material of a share of the bank's roads, pavements and grounds by that of any of them."""
    names = [f"ground:{kind}" for kind in ("road", "sidewalk", "ground")]
    rows = [bank.meta["categories"].index(name) for name in names if name in bank.meta["categories"]]
    laid = bank.mesh_material[np.unique(bank.slot_mesh[np.isin(bank.slot_category, rows) & (bank.slot_mesh >= 0)])]
    materials, material = np.unique(laid), bank.mesh_material.copy()
    for z in range(bank.num_scenes):
        for row in rows:
            meshes = bank.slot_mesh[z][(bank.slot_category[z] == row) & (bank.slot_mesh[z] >= 0)]
            if len(meshes) and rng.random() < share:
                # Kerb stones have a material of their own, which is the less frequent one.
                found, counts = np.unique(bank.mesh_material[meshes], return_counts=True)
                usual = meshes[bank.mesh_material[meshes] == found[np.argmax(counts)]]
                material[usual] = rng.choice(materials)
    return dataclasses.replace(bank, mesh_material=material)


def _stands(bank: SceneBank, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """`Views.places` and `Views.weights`.

    Raises:
      ValidationError: a scene has none of the kinds of ground.
    """
    heights = _kind_heights(bank)
    places = np.zeros((bank.num_scenes, len(_OPTIONS.ground_shares), _OPTIONS.places, 3), np.float32)
    weights = np.zeros(places.shape[:2], np.float32)
    for z in range(bank.num_scenes):
        for k, (kind, share) in enumerate(_OPTIONS.ground_shares):
            cells = np.argwhere(bank.map_kind[z] == GROUND_KINDS.index(kind))
            if len(cells):
                chosen = cells[rng.integers(len(cells), size=_OPTIONS.places)] + rng.random((_OPTIONS.places, 2))
                places[z, k, :, :2] = bank.map_origin[z] + chosen * bank.map_resolution
                places[z, k, :, 2] = heights[z, GROUND_KINDS.index(kind)]
                weights[z, k] = share
        if not weights[z].any():
            raise ValidationError(
                f"scene {bank.scene_ids[z]!r}: found no ground to stand on; needed "
                f"{', '.join(kind for kind, _ in _OPTIONS.ground_shares)}."
            )
    return places, weights


def _object_classes(bank: SceneBank, table: np.ndarray) -> np.ndarray:
    """(Z, N) class of the object in each visual slot, -1 for ground, empty slots and objects of no group."""
    kinds = table[bank.slot_category, 0]
    return np.where((bank.slot_mesh >= 0) & (kinds > classes.FIRST_OBJECT), kinds, -1)


def _balance(bank: SceneBank, table: np.ndarray) -> np.ndarray:
    """`Views.balance`: the inverse root of a class's frequency, between a third and three times the mean.

    The root is a compromise between equal objects and equal classes, as in the sampling of Mahajan et al. (ECCV 2018).
    """
    kinds = _object_classes(bank, table)
    counts = np.bincount(kinds[kinds >= 0], minlength=len(classes.names()))
    rarer = 1.0 / np.sqrt(np.maximum(counts, 1.0))
    mean = (counts * rarer).sum() / max(counts.sum(), 1)
    return np.where(counts > 0, np.clip(rarer / max(mean, 1e-9), 1 / 3, 3.0), 1.0).astype(np.float32)


def _aimed(
    bank: SceneBank, table: np.ndarray, places: np.ndarray, weights: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """`Views.aimed`. The class of an object is drawn first, and all classes of a scene are equally likely.

    A scene without objects, or without a point at `target_distance` of the object drawn, takes a random point and yaw.
    """
    kinds = _object_classes(bank, table)
    out = np.zeros((bank.num_scenes, _OPTIONS.targets, 4), np.float32)
    low, high = _OPTIONS.target_distance
    for z in range(bank.num_scenes):
        stands = places[z][weights[z] > 0].reshape(-1, 3)
        slots = np.flatnonzero(kinds[z] >= 0)
        found, inverse, counts = np.unique(kinds[z, slots], return_inverse=True, return_counts=True)
        share = 1.0 / (counts[inverse] * max(len(found), 1))
        chosen = rng.choice(slots, _OPTIONS.targets, p=share) if len(slots) else np.zeros(_OPTIONS.targets, int)
        for t, slot in enumerate(chosen):
            offset = bank.slot_position[z, slot, :2] - stands[:, :2]
            near = np.flatnonzero((np.hypot(*offset.T) > low) & (np.hypot(*offset.T) < high)) if len(slots) else ()
            at = int(rng.choice(near)) if len(near) else int(rng.integers(len(stands)))
            yaw = np.arctan2(offset[at, 1], offset[at, 0]) if len(near) else rng.uniform(-np.pi, np.pi)
            out[z, t] = *stands[at], yaw
    return out


def _kind_heights(bank: SceneBank) -> np.ndarray:
    """(Z, kinds) m, median height of a scene's ground by kind; ramps are rare and ignored."""
    tops = bank.prism_position[..., 2] + (bank.hull_box[..., 0, 2] + bank.hull_box[..., 1, 2])[bank.prism_hull]
    out = np.zeros((bank.num_scenes, len(GROUND_KINDS)), np.float32)
    for z in range(bank.num_scenes):
        for kind in range(len(GROUND_KINDS)):
            of_kind = (bank.prism_kind[z] == kind) & (bank.prism_hull[z] >= 0)
            if of_kind.any():
                out[z, kind] = np.median(tops[z][of_kind])
    return out
