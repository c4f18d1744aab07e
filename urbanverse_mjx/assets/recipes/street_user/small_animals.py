"""Small animals: hedgehog, rabbit, squirrel, raccoon; and water and farm birds."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, mix, shade
from ...meshes.recipe import recipe
from ...meshes.shapes import Point3, Points3
from ..shared.sizes import fitted
from .animals import ring


def eyes(b: MeshBuilder, at: Point3, radius: float, color: Color = "#17120e") -> None:
    x, y, z = at
    for side in (-1, 1):
        b.ball(radius, (x, side * y, z), color, segments=7, rings=5)


def pointed_ear(b: MeshBuilder, root: Point3, tip: Point3, width: float, color: Color) -> None:
    """A pair of ears, mirrored over the plane of symmetry."""
    for side in (-1, 1):
        p, q = np.array(root) * [1, side, 1], np.array(tip) * [1, side, 1]
        mid = p + (q - p) * 0.4
        b.convex(
            [
                p + [width * 0.3, 0, 0],
                p - [width * 0.3, 0, 0],
                q,
                mid + [0, width, 0],
                mid - [0, width, 0],
                mid + [width * 0.4, 0, 0],
            ],
            color,
        )


def paws(b: MeshBuilder, places: tuple[tuple[float, float], ...], top: float, radius: float, color: Color) -> None:
    """Four short legs: (x, y) of the front and hind left ones, mirrored."""
    for x, y in places:
        for side in (-1, 1):
            b.tube([(x - 0.2 * radius, side * y, top), (x, side * y, radius)], [radius * 1.3, radius], color, sides=7)
            b.ball(
                (radius * 1.6, radius, radius * 0.7),
                (x + radius * 0.7, side * y, radius * 0.7),
                color,
                segments=8,
                rings=5,
            )


@recipe("hedgehog", 2, name="small_creatures.hedgehog")
def hedgehog(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=1.0)
    spine, face = (("#5b4632", "#c9a983"), ("#3f342a", "#a98a68"))[variant]
    b.ball((0.098, 0.062, 0.058), (-0.015, 0, 0.064), spine, segments=14, rings=9)
    b.ball((0.09, 0.058, 0.035), (-0.01, 0, 0.036), face, segments=12, rings=6)
    b.tube([(0.05, 0, 0.058), (0.085, 0, 0.05), (0.118, 0, 0.044)], [0.036, 0.024, 0.008], face, sides=9)
    b.ball(0.009, (0.122, 0, 0.046), "black", segments=7, rings=5)
    eyes(b, (0.088, 0.019, 0.062), 0.006)
    for side in (-1, 1):
        b.ball((0.008, 0.010, 0.011), (0.06, side * 0.032, 0.075), shade(face, 0.8), segments=7, rings=5)
    paws(b, ((0.045, 0.035), (-0.06, 0.035)), 0.03, 0.010, shade(face, 0.7))
    # Spines: small cones over the back, rooted on the ellipsoid, leaning backwards.
    golden = np.pi * (3 - 5**0.5)
    for k in range(120):
        up = 1 - 1.15 * (k + 0.5) / 120
        a = golden * k
        r = np.sqrt(1 - up**2)
        n = np.array([r * np.cos(a), r * np.sin(a), up])
        at = n * [0.096, 0.060, 0.056] + [-0.015, 0, 0.064]
        if at[0] > 0.062:
            continue
        tip = at + 0.024 * (n + [-0.55, 0, 0.1])
        side = np.cross(n, [1.0, 0.2, 0.1])
        side *= 0.0055 / np.linalg.norm(side)
        other = np.cross(n, side)
        b.convex(
            [at + side, at - 0.5 * side + 0.87 * other, at - 0.5 * side - 0.87 * other, tip],
            mix(spine, "cream", 0.25 * (k % 3)),
        )
    names = ("A brown hedgehog", "A dark hedgehog")
    return fitted(b.build(names[variant], {"coat": spine}), ((0.23, 0.14, 0.13), (0.27, 0.16, 0.15))[variant])


@recipe("rabbit", 3, name="small_creatures.rabbit")
def rabbit(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.95)
    coat, belly = (("#8f7556", "#d9cdb9"), ("#eeeae2", "#eeeae2"), ("#6d6a68", "#bdb8b2"))[variant]
    rows = [
        (-0.17, 0.09, 0.02, 0.03),
        (-0.14, 0.10, 0.065, 0.075),
        (-0.07, 0.105, 0.075, 0.085),
        (0.02, 0.10, 0.058, 0.065),
        (0.09, 0.11, 0.042, 0.05),
        (0.12, 0.13, 0.03, 0.035),
    ]
    b.loft([ring(x, z, w, h) for x, z, w, h in rows], coat, crease_deg=70)
    for side in (-1, 1):
        b.ball((0.07, 0.035, 0.065), (-0.09, side * 0.055, 0.075), coat, (0, 20, 0), segments=10, rings=7)
        b.ball((0.06, 0.02, 0.016), (-0.05, side * 0.06, 0.016), belly, segments=9, rings=5)
        b.tube([(0.08, side * 0.03, 0.09), (0.09, side * 0.03, 0.012)], [0.022, 0.014], coat, sides=7)
        b.ball((0.024, 0.014, 0.012), (0.10, side * 0.03, 0.012), belly, segments=8, rings=5)
        ear = [
            (0.12, side * 0.018, 0.20),
            (0.10, side * 0.032, 0.25),
            (0.075, side * 0.036, 0.30),
            (0.055, side * 0.034, 0.33),
        ]
        with b.frame():
            b.tube(ear, [0.010, 0.019, 0.017, 0.004], coat, sides=6)
            b.tube([(x + 0.012, y, z) for x, y, z in ear[:3]], [0.004, 0.011, 0.008], "pink", sides=5)
    b.ball((0.052, 0.040, 0.044), (0.135, 0, 0.17), coat, segments=12, rings=8)
    b.ball((0.028, 0.028, 0.024), (0.172, 0, 0.155), belly, segments=9, rings=6)
    b.ball((0.006, 0.009, 0.006), (0.197, 0, 0.165), "pink", segments=6, rings=4)
    eyes(b, (0.155, 0.032, 0.182), 0.008, "#17120e" if variant != 1 else "#8a2030")
    b.ball(0.032, (-0.175, 0, 0.11), "white", segments=9, rings=6)
    names = ("A brown wild rabbit", "A white rabbit", "A grey rabbit")
    size = ((0.36, 0.15, 0.27), (0.40, 0.17, 0.32), (0.30, 0.14, 0.24))[variant]
    return fitted(b.build(names[variant], {"coat": coat}), size)


@recipe("squirrel", 2, name="small_creatures.squirrel")
def squirrel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Sitting up with a nut, its tail over the back."""
    b = MeshBuilder(roughness=0.95)
    coat, belly = (("#a5522a", "#efe3d0"), ("#77716a", "#e6e2da"))[variant]
    b.tube(
        [(-0.03, 0, 0.045), (0.0, 0, 0.08), (0.025, 0, 0.125), (0.035, 0, 0.15)],
        [0.042, 0.046, 0.034, 0.022],
        coat,
        sides=10,
    )
    b.tube([(0.0, 0, 0.05), (0.025, 0, 0.085), (0.043, 0, 0.125)], [0.034, 0.036, 0.022], belly, sides=9)
    b.ball((0.033, 0.026, 0.027), (0.05, 0, 0.168), coat, segments=11, rings=8)
    b.ball((0.016, 0.014, 0.012), (0.078, 0, 0.160), belly, segments=8, rings=5)
    b.ball(0.005, (0.094, 0, 0.163), "black", segments=6, rings=4)
    eyes(b, (0.063, 0.021, 0.176), 0.006)
    pointed_ear(b, (0.042, 0.016, 0.186), (0.030, 0.024, 0.222), 0.008, coat)
    for side in (-1, 1):
        b.ball((0.040, 0.02, 0.036), (0.0, side * 0.036, 0.04), coat, segments=9, rings=6)
        b.ball((0.032, 0.011, 0.009), (0.035, side * 0.034, 0.009), coat, segments=8, rings=5)
        b.tube(
            [(0.035, side * 0.028, 0.12), (0.055, side * 0.030, 0.095), (0.078, side * 0.010, 0.110)],
            [0.012, 0.010, 0.007],
            coat,
            sides=6,
        )
    b.ball((0.011, 0.011, 0.013), (0.083, 0, 0.112), "#6b4423", segments=8, rings=6)
    tail = [
        (-0.05, 0, 0.03),
        (-0.105, 0, 0.06),
        (-0.12, 0, 0.13),
        (-0.095, 0, 0.195),
        (-0.11, 0, 0.235),
        (-0.14, 0, 0.235),
    ]
    b.tube(tail, [0.016, 0.034, 0.042, 0.040, 0.030, 0.008], shade(coat, 1.1), sides=9)
    names = ("A red squirrel with a nut", "A grey squirrel with a nut")
    return fitted(b.build(names[variant], {"coat": coat}), ((0.27, 0.092, 0.21), (0.31, 0.105, 0.25))[variant])


@recipe("raccoon", 2, name="small_creatures.raccoon")
def raccoon(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.95)
    coat = ("#7b766e", "#6a5b4a")[variant]
    rows = [
        (-0.20, 0.17, 0.04, 0.05),
        (-0.16, 0.17, 0.09, 0.10),
        (-0.06, 0.165, 0.105, 0.115),
        (0.06, 0.155, 0.085, 0.09),
        (0.14, 0.165, 0.06, 0.065),
    ]
    b.loft([ring(x, z, w, h) for x, z, w, h in rows], coat, crease_deg=70)
    paws(b, ((0.10, 0.055), (-0.13, 0.065)), 0.12, 0.022, "#2b2724")
    b.ball((0.070, 0.078, 0.062), (0.195, 0, 0.205), coat, segments=12, rings=8)
    b.ball((0.045, 0.084, 0.022), (0.222, 0, 0.213), "#1d1a18", segments=12, rings=6)  # the mask
    b.ball((0.045, 0.070, 0.012), (0.222, 0, 0.236), "white", segments=12, rings=5)
    b.tube([(0.23, 0, 0.19), (0.275, 0, 0.18), (0.298, 0, 0.178)], [0.042, 0.025, 0.012], "white", sides=9)
    b.ball(0.013, (0.302, 0, 0.184), "black", segments=7, rings=5)
    eyes(b, (0.250, 0.038, 0.216), 0.009, "#e8e0d0")
    pointed_ear(b, (0.185, 0.052, 0.245), (0.175, 0.062, 0.295), 0.024, coat)
    path = np.array(
        [(-0.18, 0, 0.17), (-0.24, 0, 0.15), (-0.29, 0, 0.13), (-0.33, 0, 0.12), (-0.355, 0, 0.12), (-0.38, 0, 0.125)]
    )
    for k in range(10):  # the ringed tail
        s = np.linspace(0, 5, 11)[k : k + 2]
        ends = [tuple(np.interp(t, np.arange(6), path[:, a]) for a in range(3)) for t in s]
        r = 0.042 + 0.012 * np.sin(np.pi * k / 9)
        b.tube(ends, [r, r * (1.0 if k < 9 else 0.4)], ("#2b2724", coat)[k % 2], sides=9)
    names = ("A grey raccoon with a ringed tail", "A brown raccoon")
    return fitted(b.build(names[variant], {"coat": coat}), ((0.62, 0.24, 0.32), (0.72, 0.27, 0.36))[variant])


def fowl(
    b: MeshBuilder,
    rows: list[tuple[float, float, float, float]],
    neck: Points3,
    radii: list[float],
    body: Color,
    throat: Color,
) -> None:
    """The body of a bird from rings, and its neck."""
    b.loft([ring(x, z, w, h, 12) for x, z, w, h in rows], body, crease_deg=70)
    b.tube(neck, radii, throat, sides=9)


def folded_wings(b: MeshBuilder, at: Point3, size: Point3, color: Color, pitch: float = 8.0) -> None:
    for side in (-1, 1):
        x, y, z = at
        b.ball(size, (x, side * y, z), color, (0, pitch, side * 6), segments=10, rings=6)
        b.convex(
            [
                (x - size[0] * 0.5, side * y, z + size[2] * 0.6),
                (x - size[0] * 0.5, side * y, z - size[2] * 0.5),
                (x - size[0] * 0.4, side * (y - 0.02), z),
                (x - size[0] * 1.5, side * y * 0.6, z + 0.3 * size[2]),
            ],
            shade(color, 0.85),
        )


def webbed_feet(b: MeshBuilder, x: float, y: float, top: float, size: float, color: Color, web: bool) -> None:
    for side in (-1, 1):
        b.rod((x, side * y, top), (x + size * 0.1, side * y, size * 0.1), size * 0.10, color, sides=6)
        tips = [
            (x + size * (0.1 + 0.9 * np.cos(a)), side * y + size * 0.9 * np.sin(a), 0.0)
            for a in np.radians((-32, 0, 32))
        ]
        for tip in tips:
            b.rod((x + size * 0.1, side * y, size * 0.08), (*tip[:2], size * 0.05), size * 0.06, color, sides=4)
        if web:
            b.convex([(x, side * y, 0.0), *tips, (x, side * y, size * 0.08)], color)
        else:
            b.rod(
                (x + size * 0.1, side * y, size * 0.08),
                (x - size * 0.5, side * y, size * 0.04),
                size * 0.06,
                color,
                sides=4,
            )


@recipe("duck", 3, name="small_creatures.duck")
def duck(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.7)
    body, wing, head, bill = (
        ("#8d8a86", "#77706a", "#1f5a3a", "#d8b22a"),
        ("#8a6a48", "#6b5036", "#7a5c3e", "#c98a3a"),
        ("#f2efe8", "#f2efe8", "#f2efe8", "orange"),
    )[variant]
    rows = [
        (-0.26, 0.16, 0.012, 0.012),
        (-0.20, 0.15, 0.05, 0.035),
        (-0.10, 0.135, 0.09, 0.07),
        (0.03, 0.13, 0.095, 0.08),
        (0.13, 0.14, 0.07, 0.07),
        (0.17, 0.15, 0.03, 0.035),
    ]
    fowl(b, rows, [(0.13, 0, 0.16), (0.17, 0, 0.20), (0.175, 0, 0.25)], [0.05, 0.034, 0.034], body, head)
    if variant == 0:
        b.ball((0.07, 0.065, 0.055), (0.12, 0, 0.135), "#6b3f2c", segments=10, rings=7)
        b.ring(0.036, 0.009, (0.168, 0, 0.205), "white", (0, 20, 0), 12, 5)
        for side in (-1, 1):
            b.box((0.07, 0.01, 0.025), (-0.09, side * 0.092, 0.15), "signal blue", centered=True)
    b.ball((0.048, 0.040, 0.042), (0.185, 0, 0.275), head, segments=11, rings=8)
    b.loft(
        [
            ring(x, z, w, h, 8)
            for x, z, w, h in ((0.215, 0.268, 0.022, 0.018), (0.25, 0.262, 0.022, 0.010), (0.285, 0.262, 0.024, 0.006))
        ],
        bill,
        crease_deg=60,
    )
    eyes(b, (0.205, 0.033, 0.288), 0.006)
    folded_wings(b, (-0.04, 0.085, 0.155), (0.13, 0.025, 0.05), wing)
    webbed_feet(b, 0.0, 0.045, 0.07, 0.05, "orange", True)
    names = ("A mallard drake", "A brown duck", "A white duck")
    size = ((0.55, 0.20, 0.32), (0.50, 0.19, 0.30), (0.58, 0.23, 0.38))[variant]
    return fitted(b.build(names[variant], {"plumage": head}), size)


@recipe("swan", 2, name="small_creatures.swan")
def swan(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.7)
    body, bill = (("#f3f1ea", "safety orange"), ("#26262a", "signal red"))[variant]
    rows = [
        (-0.60, 0.34, 0.02, 0.02),
        (-0.46, 0.30, 0.12, 0.08),
        (-0.22, 0.25, 0.20, 0.15),
        (0.06, 0.23, 0.21, 0.17),
        (0.30, 0.25, 0.15, 0.14),
        (0.40, 0.28, 0.07, 0.08),
    ]
    neck = [(0.30, 0, 0.30), (0.44, 0, 0.38), (0.46, 0, 0.52), (0.38, 0, 0.66), (0.38, 0, 0.78), (0.44, 0, 0.84)]
    fowl(b, rows, neck, [0.10, 0.065, 0.05, 0.045, 0.045, 0.05], body, body)
    b.ball((0.085, 0.055, 0.055), (0.48, 0, 0.835), body, segments=11, rings=8)
    b.loft(
        [
            ring(x, z, w, h, 8)
            for x, z, w, h in ((0.53, 0.825, 0.035, 0.03), (0.59, 0.80, 0.028, 0.018), (0.645, 0.785, 0.022, 0.010))
        ],
        bill,
        crease_deg=60,
    )
    b.ball((0.022, 0.026, 0.022), (0.535, 0, 0.85), "black", segments=8, rings=6)
    eyes(b, (0.52, 0.046, 0.845), 0.010)
    folded_wings(b, (-0.10, 0.17, 0.34), (0.34, 0.06, 0.14), shade(body, 0.97 if variant == 0 else 1.3), 14)
    folded_wings(b, (-0.16, 0.10, 0.40), (0.28, 0.05, 0.10), body, 18)
    webbed_feet(b, -0.02, 0.09, 0.10, 0.11, "charcoal", True)
    names = ("A white mute swan", "A black swan")
    return fitted(b.build(names[variant], {"plumage": body}), ((1.25, 0.44, 0.88), (1.15, 0.42, 0.85))[variant])


@recipe("chicken", 3, name="small_creatures.chicken")
def chicken(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.8)
    body, tail = (("#a8582c", "#6d3418"), ("#efe9dc", "#d8d0c0"), ("#8a3a1c", "#1f3a34"))[variant]
    cock = variant == 2
    rows = [
        (-0.13, 0.24, 0.02, 0.03),
        (-0.09, 0.21, 0.06, 0.06),
        (-0.02, 0.17, 0.082, 0.085),
        (0.06, 0.175, 0.07, 0.08),
        (0.11, 0.21, 0.035, 0.045),
    ]
    top = 0.36 if not cock else 0.40
    fowl(
        b,
        rows,
        [(0.08, 0, 0.20), (0.105, 0, 0.28), (0.11, 0, top - 0.02)],
        [0.06, 0.038, 0.028],
        body,
        "#d8a23a" if cock else body,
    )
    b.ball((0.030, 0.025, 0.028), (0.118, 0, top), body if not cock else "#d8a23a", segments=10, rings=7)
    b.convex(
        [(0.14, 0.011, top + 0.004), (0.14, -0.011, top + 0.004), (0.142, 0, top - 0.012), (0.172, 0, top - 0.006)],
        "amber",
    )
    comb = [
        (0.085, 0.015),
        (0.088, 0.045),
        (0.102, 0.03),
        (0.112, 0.055),
        (0.125, 0.032),
        (0.137, 0.048),
        (0.145, 0.012),
    ]
    k = 1.0 if not cock else 1.4
    b.profile([(0.115 + (x - 0.115) * k, top + z * k) for x, z in comb], 0.012, (0, 0, 0), "signal red")
    for side in (-1, 1):
        b.ball((0.010, 0.006, 0.018 * k), (0.138, side * 0.008, top - 0.03 * k), "signal red", segments=7, rings=5)
    eyes(b, (0.128, 0.021, top + 0.008), 0.005, "#17120e")
    folded_wings(b, (-0.02, 0.075, 0.19), (0.085, 0.02, 0.05), shade(body, 0.85), -6)
    fan = [(-0.10, 0.20), (-0.11, 0.27), (-0.16, 0.34), (-0.20, 0.33), (-0.19, 0.27), (-0.15, 0.21)]
    for y in (-0.02, 0.0, 0.02):
        b.profile([(x, z) for x, z in fan], 0.014, (0, y, 0), tail)
    if cock:
        for j in range(4):
            y = 0.02 * (j - 1.5)
            b.tube(
                [(-0.12, y, 0.26), (-0.17, y, 0.37), (-0.235, y * 1.4, 0.36), (-0.27, y * 1.6, 0.26)],
                [0.014, 0.016, 0.013, 0.003],
                tail,
                sides=5,
            )
    webbed_feet(b, 0.0, 0.035, 0.11, 0.05, "amber", False)
    names = ("A brown hen", "A white hen", "A cock with a green tail")
    size = ((0.38, 0.19, 0.41), (0.35, 0.18, 0.38), (0.46, 0.20, 0.52))[variant]
    return fitted(b.build(names[variant], {"cock": cock}), size)
