"""Walls, and loose objects on the ground: rubble, stones, hewn blocks, branches, breakwater blocks."""

import dataclasses

import numpy as np

from ...meshes import paint, shapes
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ...meshes.shapes import Shape
from ..shared.sizes import fitted


def boulder(rng: np.random.Generator, size: tuple[float, float, float], points: int = 26, flat: float = 0.4) -> Shape:
    """The hull of random points on an ellipsoid, its foot cut flat (`flat` = share of the half height kept)."""
    p = rng.normal(size=(points, 3))
    p /= np.linalg.norm(p, axis=1, keepdims=True)
    p *= rng.uniform(0.86, 1.0, (points, 1))
    p[:, 2] = np.maximum(p[:, 2], -flat)
    return shapes.convex(p * np.asarray(size) / 2 + [0, 0, flat * size[2] / 2])


@recipe("wall", 4, name="loose_matter.wall")
def wall(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.9)
    width, height, depth = ((3.6, 1.9, 0.28), (5.0, 2.4, 0.25), (3.0, 1.1, 0.45), (4.2, 1.5, 0.24))[variant]
    if variant == 2:
        _dry_stone(b, rng, width, height, depth)
    else:
        _masonry(b, variant, rng, width, height, depth)
    names = (
        "A brick garden wall with a stone coping",
        "A concrete wall of cast panels",
        "A dry stone wall",
        "A plastered wall with a tiled top",
    )
    built = fitted(b.build(names[variant], {"height": height}), (depth, width, height))
    # Piers and ribs run through the wall, so the parts' sum counts them twice: the wall fills its box but for 4 %.
    return dataclasses.replace(built, volume=0.96 * depth * width * height)


def _dry_stone(b: MeshBuilder, rng: np.random.Generator, width: float, height: float, depth: float) -> None:
    """Stone course over course, with a coping of stones on edge."""
    rows = 5
    for k in range(rows):
        y, h = -width / 2, height / rows * 0.92
        while y < width / 2 - 0.05:
            w = min(float(rng.uniform(0.3, 0.6)), width / 2 - y)
            tone = shade("sandstone", float(rng.uniform(0.72, 1.0)))
            size = (depth * float(rng.uniform(0.88, 1.0)), w - 0.015, h * float(rng.uniform(0.92, 1.0)))
            b.box(size, (0, y + w / 2, k * h), tone, bevel=0.03)
            y += w
    y = -width / 2
    while y < width / 2 - 0.08:  # the coping: stones on edge
        w = min(float(rng.uniform(0.12, 0.2)), width / 2 - y)
        b.box(
            (depth, w - 0.01, height * 0.15),
            (0, y + w / 2, height * 0.92 - 0.02),
            shade("sandstone", 0.8),
            bevel=0.025,
        )
        y += w


def _masonry(b: MeshBuilder, variant: int, rng: np.random.Generator, width: float, height: float, depth: float) -> None:
    """A wall of brick, concrete or plaster with its cap."""
    style, color = (("brick", "brick"), ("", "concrete"), ("", ""), ("", "cream"))[variant]
    if style == "brick":
        face = np.asarray(brick_image((192, 104), color))
    else:
        face = np.asarray(paint.speckled((128, 64), color, rng, 7))
    b.box((depth - 0.04, width - 0.06, height - 0.08), (0, 0, 0), color, skins={"+x": face, "-x": face})
    cap = "sandstone" if variant == 0 else "dark concrete" if variant == 1 else "terracotta"
    if variant == 3:
        for k in range(14):
            y = -width / 2 + (k + 0.5) * width / 14
            b.cylinder(depth * 0.5, width / 14 - 0.01, (0, y + width / 28, height - 0.10), cap, (90, 0, 0), segments=8)
    else:
        b.box((depth, width, 0.08), (0, 0, height - 0.08), cap, bevel=0.01)
    for side in (-1, 1) if variant == 0 else ():
        b.box((depth, 0.36, height - 0.06), (0, side * (width / 2 - 0.18), 0), shade(color, 0.85))
    if variant == 1:
        for k in range(1, 4):
            b.box((depth - 0.01, 0.03, height - 0.1), (0, -width / 2 + k * width / 4, 0), "dark concrete")
        for k in range(8):
            y, z = -width / 2 + 0.5 + (k % 4) * 1.3, 0.7 + (k // 4) * 1.0
            b.cylinder(0.03, depth - 0.015, (-(depth - 0.015) / 2, y, z), "dark grey", (0, 90, 0), segments=6)


def brick_image(size: tuple[int, int], color: Color) -> np.ndarray:
    """Bricks in running bond, 16 to a row."""
    rng = np.random.default_rng(7)
    image, pen = paint.canvas((size[0] * 2, size[1] * 2), "#b9ada0")
    w, h = image.size
    step, rise = w / 12, h / 16
    for row in range(16):
        for k in range(-1, 13):
            x = (k + 0.5 * (row % 2)) * step
            tone = shade(color, float(rng.uniform(0.8, 1.15)))
            pen.rectangle((x + 2, row * rise + 2, x + step - 2, (row + 1) * rise - 1), fill=tone)
    return np.asarray(paint.shrunk(image, size))


@recipe("concrete tetrapod", 3, name="loose_matter.tetrapod")
def tetrapod(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.95)
    color = ("concrete", "dark concrete", "sandstone")[variant]
    legs = np.array([(0, 0, 1.0)] + [(0.943 * np.cos(a), 0.943 * np.sin(a), -0.333) for a in np.radians((0, 120, 240))])
    for leg in legs:
        tip = leg * 0.86
        b.tube([(0, 0, 0), tuple(tip * 0.35), tuple(tip), tuple(leg * 0.93)], [0.40, 0.36, 0.24, 0.19], color, sides=12)
    b.ball(0.40, (0, 0, 0), color, segments=12, rings=8)
    names = ("A concrete tetrapod", "A weathered tetrapod", "A small tetrapod of pale concrete")
    size = ((1.46, 1.50, 1.40), (1.90, 1.95, 1.80), (0.95, 0.98, 0.92))[variant]
    return fitted(b.build(names[variant], {"legs": 4}), size)


@recipe("debris", 3, name="loose_matter.debris")
def debris(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.95)
    tones = (
        ("concrete", "dark concrete", "brick"),
        ("brick", "terracotta", "concrete"),
        ("grey wood", "wood", "dark wood"),
    )[variant]
    mound = boulder(rng, (1.2, 0.9, 0.55), 30, 0.05)
    b.add(mound, ("dark concrete", "#9c6a50", "soil")[variant], (0, 0, -0.02))
    for k in range(34 if variant < 2 else 18):
        a, r = rng.uniform(0, 2 * np.pi), np.sqrt(rng.uniform()) * 0.55
        x, y = r * np.cos(a) * 1.05, r * np.sin(a) * 0.8
        z = max(0.24 * (1 - (r / 0.62) ** 2), 0.02)
        turn = tuple(float(v) for v in rng.uniform(-60, 60, 3))
        tone = shade(tones[k % 3], float(rng.uniform(0.8, 1.1)))
        if variant == 1 and k % 2:
            b.box((0.22, 0.10, 0.065), (x, y, z), tone, turn, centered=True)
        elif variant < 2:
            s = float(rng.uniform(0.12, 0.26))
            b.add(boulder(rng, (s * 1.4, s, s), 12, 0.8), tone, (x, y, z), turn)
        else:
            b.box(
                (float(rng.uniform(0.5, 1.1)), 0.10, 0.025),
                (x * 0.5, y * 0.7, z + 0.04),
                tone,
                (turn[0] * 0.3, turn[1] * 0.4, turn[2] * 3),
                centered=True,
            )
    for k in range(3):  # bent reinforcing bars, or planks across the heap
        if variant == 0:
            y = -0.25 + 0.25 * k
            b.tube(
                [(-0.3, y, 0.15), (0.05 * k, y + 0.05, 0.34), (0.35, y + 0.12, 0.40 - 0.1 * k)], 0.010, "rust", sides=5
            )
        elif variant == 1:
            b.box((0.9, 0.11, 0.03), (0.05, -0.2 + 0.2 * k, 0.27), "grey wood", (8, 12 - 9 * k, 35 * k), centered=True)
        else:
            b.add(boulder(rng, (0.25, 0.2, 0.18), 12, 0.8), "concrete", (0.4 - 0.4 * k, 0.25 * (-1) ** k, 0.05))
    names = ("A heap of broken concrete with bars", "A heap of bricks and boards", "A pile of splintered boards")
    size = ((1.0, 1.3, 0.38), (1.25, 1.6, 0.48), (1.25, 1.2, 0.44))[variant]
    return fitted(
        b.build(names[variant], {"kind": ("concrete", "brick", "wood")[variant]}), (size[1], size[0], size[2])
    )


@recipe("stone", 4, name="loose_matter.stone")
def stone(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.95)
    color = ("granite", "sandstone", "#7c7468", "dark grey")[variant]
    size = ((0.28, 0.22, 0.15), (0.45, 0.34, 0.26), (0.14, 0.11, 0.06), (0.70, 0.52, 0.38))[variant]
    shape = boulder(rng, size, (110, 60, 130, 50)[variant], (0.55, 0.5, 0.7, 0.45)[variant])
    b.add(shape, shade(color, float(rng.uniform(0.95, 1.05))), crease_deg=(32, 15, 60, 12)[variant])
    names = ("A grey granite stone", "A sandstone field stone", "A smooth pebble", "A dark split stone")
    flat = (*size[:2], size[2] if variant < 3 else 0.0)  # a split stone lies as low as it broke
    return fitted(b.build(names[variant], {"stone": color}), flat)


@recipe("stone block", 3, name="loose_matter.stone_block")
def stone_block(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.9)
    size = ((0.62, 0.42, 0.36), (0.95, 0.50, 0.45), (0.42, 0.40, 0.40))[variant]
    color = ("granite", "sandstone", "concrete")[variant]
    face = np.asarray(paint.speckled((48, 32), color, rng, 12))
    x, y, z = size[1], size[0], size[2]
    b.box((x - 0.01, y - 0.01, z), color=color, bevel=(0.02, 0.035, 0.015)[variant])
    for k, facing in enumerate(("+x", "-x", "+y", "-y", "+z")):
        across = (y if "x" in facing else x) * 0.86
        up = (z if facing != "+z" else x) * 0.84
        across = y * 0.86 if facing == "+z" else across
        where = {"+x": (x / 2 - 0.003, 0, z / 2), "-x": (-x / 2 + 0.003, 0, z / 2), "+y": (0, y / 2 - 0.003, z / 2)}
        where |= {"-y": (0, -y / 2 + 0.003, z / 2), "+z": (0, 0, z + 0.002)}
        b.panel(np.roll(face, 7 * k, 1), where[facing], across, up, facing)
    if variant == 1:  # drill marks along the split edge
        for k in range(7):
            b.cylinder(
                0.012, z * 0.5, (x / 2 - 0.008, -y * 0.4 + y * 0.8 * k / 6, z * 0.48), shade(color, 0.7), segments=6
            )
    if variant == 2:  # a lifting eye
        b.ring(0.045, 0.010, (0, 0, z + 0.02), "rust", (90, 0, 0), 12, 5)
    names = ("A granite block", "A sandstone block with drill marks", "A concrete block with a lifting eye")
    return fitted(b.build(names[variant], {"stone": color}), (x, y, z if variant < 2 else 0.44))


@recipe("tree debris", 3, name="loose_matter.tree_debris")
def tree_debris(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.95)
    if variant == 1:  # three cut logs in a heap
        for y, z, x in ((-0.24, 0.20, 0.0), (0.22, 0.19, 0.12), (0.0, 0.53, -0.08)):
            b.cylinder(0.20, 1.5, (x - 0.75, y, z), "bark", (0, 90, 0), segments=12, top_radius=0.185)
            for end in (-0.752, 0.70):
                for r, color in ((0.175, "light wood"), (0.11, "beige"), (0.05, "light wood")):
                    out = 0.004 * (3 - r * 10) + 0.055
                    b.cylinder(
                        r, 0.01, (x + end + (out if end > 0 else -out + 0.045), y, z), color, (0, 90, 0), segments=12
                    )
        b.rod((0.2, 0.3, 0.3), (0.45, 0.5, 0.55), 0.05, "bark", sides=6)
        return fitted(b.build("A heap of cut logs", {"kind": "logs"}), (1.65, 0.85, 0.72))
    trunk = [(-1.0, -0.05, 0.10), (-0.4, 0.02, 0.13), (0.1, 0.0, 0.20), (0.6, 0.08, 0.24), (1.0, 0.05, 0.30)]
    b.tube(trunk, [0.085, 0.075, 0.06, 0.04, 0.02], "bark", sides=8)
    b.cylinder(0.07, 0.02, (-1.01, -0.05, 0.10), "light wood", (0, -90, 0), segments=10)
    leaf = ("dark leaf", "", "yellow leaf")[variant]
    for k in range(9):
        share = 0.25 + 0.08 * k
        base = np.array([np.interp(share, np.linspace(0, 1, 5), np.array(trunk)[:, a]) for a in range(3)])
        side = (-1) ** k
        tip = base + np.array(
            [0.32 + 0.1 * rng.uniform(), side * (0.28 + 0.14 * rng.uniform()), rng.uniform(-0.08, 0.14)]
        )
        tip[2] = max(tip[2], 0.05)
        b.tube(
            [tuple(base), tuple((base + tip) / 2 + [0, 0, 0.04]), tuple(tip)], [0.025, 0.016, 0.008], "bark", sides=5
        )
        if variant == 2 and k % 3:
            continue
        for j in range(4):
            at = base + (tip - base) * (0.45 + 0.2 * j) + rng.uniform(-0.05, 0.05, 3)
            at[2] = max(at[2], 0.03)
            turn = tuple(float(v) for v in rng.uniform(-50, 50, 3))
            b.ball(
                (0.10, 0.055, 0.014), tuple(at), shade(leaf, float(rng.uniform(0.8, 1.2))), turn, segments=6, rings=4
            )
    names = ("A fallen branch with green leaves", "", "A bare broken branch with a few yellow leaves")
    size = ((2.1, 0.90, 0.43), (0, 0, 0), (2.6, 0.95, 0.46))[variant]
    return fitted(b.build(names[variant], {"kind": "branch"}), size)
