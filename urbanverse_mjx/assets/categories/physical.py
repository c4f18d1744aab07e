"""Computes consistent physical values of asset records: sizes, materials, mass, friction and force.

They are drawn from the leaf's prior, seeded by the record's uid only. Only + - * / and square roots are used, which
every machine rounds alike. If a recipe's mesh is measured, its box and volume replace the drawn ones, and the other
values follow from them:

    solid = length * width * height * fill                  (m^3; fill from the prior, thinner walls for larger objects)
    mass = solid * density of the materials                 (kg)
    air = 1 - solid / volume inside the outer surface       (the rest of `materials_composition`)
    required_force = coefficient * mass * g                 (N; friction of what touches the ground, or rolling)
"""

import dataclasses
import hashlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from urbanverse_mjx.datatypes import AssetRecord, ValidationError

from .materials import AIR, material
from .priors import Make, Prior, prior

Floats = NDArray[np.float64]

GRAVITY = 9.81  # m/s^2
# N, force that one person can apply briefly; ISO 11228-2 tabulates 200-300 N of initial force for 90 % of adults.
ONE_PERSON_PUSH = 300.0
# Rolling resistance of small wheels at the start: between car tyres on asphalt (0.02, source `etbroll`) and the
# 0.1 and more of small hard castors (lever arm of 10 mm, source `cda3000`).
ROLLING_RESISTANCE = 0.05
# Share of the deviation from the median that length, width and height have in common (a large table is large in all
# three); our judgement.
COMMON_SIZE_SHARE = 0.6
# Spread of the fill: least for solid objects, most for hollow ones, whose walls differ.
SOLID_SPREAD, HOLLOW_SPREAD = 0.02, 0.12
# Relative, to either side: body mass at one height, from the 5th to the 95th percentile of adults' body mass index.
BUILD_SPREAD = 0.28
MAKE_SPREAD = 0.3  # relative, to either side: mass of one make of a leaf that has several
FRICTION_SPREAD = 0.1  # relative, to either side: wear, dirt and the paving
NUM_DRAWS = 16  # numbers per record; `sample` documents the use of each
SIZE_STEP, MASS_STEP = 1e-4, 1e-6  # m and kg that sizes and masses are rounded to


@dataclasses.dataclass(frozen=True)
class Measured:
    """Physical data that a recipe gives for its meshes.

    Attributes:
      extent: (n, 3) m, box in the asset frame (x towards the front).
      volume: (n,) m^3 inside the outer surface.
      make: (n,) index into the prior's makes that the recipe uses, or None to draw it.
    """

    extent: Floats
    volume: Floats
    make: NDArray[np.int64] | None = None


@dataclasses.dataclass(frozen=True)
class Physical:
    """Values of n records of one leaf; arrays have the shape (n,) unless stated otherwise.

    Attributes:
      extent: (n, 3) m, box in the asset frame.
      length, width, height: m; length >= width.
      volume: m^3 inside the outer surface.
      solid: m^3 of it that is matter.
      make: index into the prior's makes.
      mass: kg.
      friction: friction coefficient of the contact material on pavement.
      force: N, force that moves the object.
      movable: whether one person can move it.
    """

    extent: Floats
    length: Floats
    width: Floats
    height: Floats
    volume: Floats
    solid: Floats
    make: NDArray[np.int64]
    mass: Floats
    friction: Floats
    force: Floats
    movable: NDArray[np.bool_]


def uniforms(uids: Sequence[str]) -> Floats:
    """(n, NUM_DRAWS) pseudo-random numbers in (0, 1) from a hash of the uid, the same on every machine."""
    text = b"".join(hashlib.blake2b(uid.encode("utf-8")).digest() for uid in uids)
    words = np.frombuffer(text, dtype="<u4").reshape(len(uids), NUM_DRAWS)
    return (words.astype(np.float64) + 0.5) / 2.0**32


def medians(count: int = 1) -> Floats:
    """The draws that yield a leaf's median record of its most common make."""
    draws = np.full((count, NUM_DRAWS), 0.5)
    draws[:, 9] = 0.0
    return draws


def sample(row: Prior, draws: Floats, measured: Measured | None = None) -> Physical:
    """Values of the records with these draws.

    Draws 0-1 determine the common size, 2-3, 4-5 and 6-7 length, width and height, 8 the fill, 9 the make, 10 the
    friction, 11-12 the build (people) or the mass (if it does not depend on size); the others are unused.

    Raises:
      ValidationError: measured values of another number of records, or not above 0.
    """
    count = len(draws)
    if measured is None:
        length, width, height = _sizes(row, draws)
        extent = np.stack((*((width, length) if row.front == "side" else (length, width)), height), axis=1)
        volume = length * width * height * row.bulk
        make = _makes(row, draws[:, 9])
    else:
        _check(measured, count)
        extent = _rounded(measured.extent, SIZE_STEP)
        length, width = extent[:, :2].max(1), extent[:, :2].min(1)
        height = extent[:, 2]
        volume = np.minimum(measured.volume, length * width * height)
        make = _makes(row, draws[:, 9]) if measured.make is None else measured.make
    mass, solid = _mass(row, make, draws, (length, width, height), volume)
    if row.rest == "alive" and measured is None:  # bodies hold no air that one would call hollow
        volume = solid
    friction = material(row.contact).friction * (1.0 + FRICTION_SPREAD * (2.0 * draws[:, 10] - 1.0))
    friction = _rounded(friction, 0.01)
    coefficient = np.full(count, ROLLING_RESISTANCE) if row.rest == "rolls" else friction
    force = coefficient * mass * GRAVITY
    movable = (force <= ONE_PERSON_PUSH) & (row.rest not in ("fixed", "hangs"))
    return Physical(extent, length, width, height, volume, solid, make, mass, friction, force, movable)


def sample_uids(leaf: str, uids: Sequence[str], measured: Measured | None = None) -> Physical:
    """Values of records of one leaf by their uids.

    Raises:
      UnknownLabelError: no such leaf.
      ValidationError: measured values that do not fit.
    """
    return sample(prior(leaf), uniforms(uids), measured)


def sample_meshes(
    leaf: str, uids: Sequence[str], extent: Floats, volume: Floats, guess: Sequence[float] | None = None
) -> Physical:
    """Values of records whose meshes were measured.

    Args:
      leaf: exact leaf name.
      uids: n of them.
      extent: (n, 3) m, boxes in the asset frame.
      volume: (n,) m^3 inside the outer surfaces.
      guess: kg, (n,) estimates of the recipe, which only select among the makes of the leaf (a heavy bench is of
        concrete).

    Raises:
      UnknownLabelError: no such leaf.
      ValidationError: arrays that do not fit.
    """
    row, draws = prior(leaf), uniforms(uids)
    make = None
    if guess is not None:
        per_make = []
        for index in range(len(row.makes)):
            one = Measured(extent, volume, np.full(len(uids), index))
            per_make.append(sample(row, draws, one).mass)
        distance = np.abs(np.log(np.stack(per_make)) - np.log(np.asarray(guess, dtype=np.float64)))
        make = distance.argmin(0)
    return sample(row, draws, Measured(extent, volume, make))


def agreeing(records: Sequence[AssetRecord]) -> list[AssetRecord]:
    """Replaces mass, materials, friction, force and movability of records by those that follow from their measured
    boxes, their volumes and the priors of their leaves.

    A record's current mass only selects among the makes of its leaf.
    """
    changed: dict[str, AssetRecord] = {}
    for leaf in dict.fromkeys(r.leaf for r in records):
        group = [r for r in records if r.leaf == leaf]
        extent, volume = np.array([r.extent_xyz for r in group]), np.array([r.volume for r in group])
        values = sample_meshes(leaf, [r.uid for r in group], extent, volume, [r.mass for r in group])
        for k, record in enumerate(group):
            make = prior(leaf).makes[values.make[k]]
            changed[record.uid] = dataclasses.replace(
                record,
                mass=round(float(values.mass[k]), 3),
                materials=tuple(name for name in composition(make, values.solid[k], values.volume[k]) if name != AIR),
                friction_coefficient=float(values.friction[k]),
                movable=bool(values.movable[k]),
                required_force=round(float(values.force[k]), 1),
            )
    return [changed[r.uid] for r in records]


def composition(make: Make, solid: float, volume: float) -> dict[str, float]:
    """material -> share of the volume inside the outer surface, including air, in descending order; sums to 1."""
    dense = solid / volume
    if dense > 1.0 - 1e-9:  # full but for rounding
        return dict(sorted(make.shares.items(), key=lambda item: -item[1]))
    shares = {name: float(share * dense) for name, share in make.shares.items()}
    shares[AIR] = 1.0 - sum(shares.values())
    return dict(sorted(shares.items(), key=lambda item: -item[1]))


def _rounded(values: Floats, step: float) -> Floats:
    digits = round(1.0 / step)
    return np.maximum(np.floor(values * digits + 0.5), 1.0) / digits


def _bent(low: float, median: float, high: float, z: Floats) -> Floats:
    """Maps z in [-1, 1] to [low, high] with 0 at the median, linearly on either side."""
    return median + np.where(z < 0.0, median - low, high - median) * z


def _sizes(row: Prior, draws: Floats) -> tuple[Floats, Floats, Floats]:
    """Length, width and height (m); each deviation is a sum of two draws, which makes medium values more likely."""
    common = draws[:, 0] + draws[:, 1] - 1.0
    sizes = []
    for axis, span in enumerate((row.length, row.width, row.height)):
        own = draws[:, 2 + 2 * axis] + draws[:, 3 + 2 * axis] - 1.0
        sizes.append(_rounded(_bent(*span, COMMON_SIZE_SHARE * common + (1.0 - COMMON_SIZE_SHARE) * own), SIZE_STEP))
    length, width, height = sizes
    width = length if row.section in ("round", "ball") else np.minimum(width, length)
    height = {"lying": width, "wheel": length, "ball": length}.get(row.section, height)
    return length, width, height


def _makes(row: Prior, draw: Floats) -> NDArray[np.int64]:
    """Draws the makes; with k makes their odds are k^2 : ... : 4 : 1, from the first to the last."""
    weights = np.arange(len(row.makes), 0, -1) ** 2
    edges = np.cumsum(weights)[:-1] / weights.sum()
    return np.searchsorted(edges, draw, side="right")


def _growth(row: Prior, dense: Floats, sizes: tuple[Floats, Floats, Floats], draws: Floats) -> Floats:
    """Mass over the make's median mass.

    For leaves whose mass grows with the box, a solid object's mass is proportional to its volume, and that of a hollow
    one to the power 3/4 of it, between a shell of constant thickness (2/3) and uniform scaling (1).
    """
    x, y, z = (size / span[1] for size, span in zip(sizes, (row.length, row.width, row.height), strict=True))
    free = draws[:, 11] + draws[:, 12] - 1.0
    if row.grows_with == "nothing":
        low, high = row.mass[0] / row.mass[1], row.mass[2] / row.mass[1]
        if len(row.makes) > 1:  # the range then spans the makes
            low, high = max(low, 1.0 - MAKE_SPREAD), min(high, 1.0 + MAKE_SPREAD)
        return _bent(low, 1.0, high, free)
    if row.grows_with == "height":
        return z * z * (1.0 + (BUILD_SPREAD if row.rest == "alive" else 0.0) * free)
    if row.grows_with in ("face", "ground", "length"):
        return {"face": x * z, "ground": x * y, "length": x}[row.grows_with]
    root = np.sqrt(x * y * z)
    return dense * x * y * z + (1.0 - dense) * root * np.sqrt(root)


def _mass(
    row: Prior, make: NDArray[np.int64], draws: Floats, sizes: tuple[Floats, Floats, Floats], volume: Floats
) -> tuple[Floats, Floats]:
    """(mass in kg, solid volume in m^3), limited to the row's range and to the volume."""
    fill = np.array([m.fill for m in row.makes])[make]
    density = np.array([m.density for m in row.makes])[make]
    dense = fill / row.bulk
    spread = SOLID_SPREAD * dense + HOLLOW_SPREAD * (1.0 - dense)
    if row.grows_with == "nothing":  # drawn from the whole range already
        spread = np.zeros_like(spread)
    mass = row.box_volume * fill * density * _growth(row, dense, sizes, draws)
    mass = mass * (1.0 + spread * (2.0 * draws[:, 8] - 1.0))
    mass = np.minimum(np.minimum(np.maximum(mass, row.mass[0]), row.mass[2]), volume * density)
    mass = _rounded(mass, MASS_STEP)
    return mass, mass / density


def _check(measured: Measured, count: int) -> None:
    shapes = (measured.extent.shape, measured.volume.shape)
    if shapes != ((count, 3), (count,)):
        raise ValidationError(f"measured geometry: found arrays of {shapes}, needed {((count, 3), (count,))}.")
    values = np.concatenate((measured.extent.ravel(), measured.volume))
    if not (np.isfinite(values).all() and (values > 0).all()):
        raise ValidationError("measured geometry: found a size or volume that is not above 0, needed metres and m^3.")
