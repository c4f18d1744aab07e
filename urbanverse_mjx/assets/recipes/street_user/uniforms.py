"""People in working clothes: fire, rescue, medicine, guards, maintenance, gardens, traffic."""

import dataclasses

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .figure import STANDING, Figure, Person, Pose
from .worn_items import cap, vest

#: Short steps: someone on duty, not in a hurry.
STEP = Pose((14, -10), (4, 15), (-9, 11), (12, 18), 2.0)
STEP_OTHER = Pose((-10, 14), (16, 4), (11, -9), (18, 12), 2.0)
#: Density of a clothed body, kg/m^3, and body mass index of the 50th percentile: they give the volume of a figure.
BODY_DENSITY, BODY_MASS_INDEX = 985.0, 23.0


def dressed(person: Person, pose: Pose) -> Figure:
    figure = Figure(MeshBuilder(roughness=0.85), person, pose)
    figure.build()
    return figure


def finished(figure: Figure, description: str, size: tuple[float, float, float], **params: object) -> BuiltAsset:
    """The asset of a figure; `size` as in `fitted` (all 0: as it is). Its volume is that of the body."""
    person = figure.person
    built = figure.builder.build(description, {"height": person.height, **params})
    built = fitted(built, size) if any(size) else built
    return dataclasses.replace(built, volume=BODY_MASS_INDEX * person.height**2 * person.girth / BODY_DENSITY)


def word(words: str, ink: Color, back: Color, size: tuple[int, int] = (64, 16)) -> np.ndarray:
    image, pen = paint.canvas((size[0] * 3, size[1] * 3), back)
    paint.text(pen, words, (6, 4, size[0] * 3 - 6, size[1] * 3 - 4), ink, 0.04)
    return np.asarray(paint.shrunk(image, size))


def badge_words(f: Figure, words: str, ink: Color, back: Color, out: float = 0.082) -> None:
    """A word across the back and a small one on the chest; `out`: how far clothes stand out, as a share of stature."""
    h, image = f.person.height, word(words, ink, back)
    behind, chest = f.trunk(0.225), f.trunk(0.225)
    f.builder.panel(image, tuple(behind - [out * h * f.person.girth, 0, 0]), 0.28, 0.07, "-x")
    at = chest + [out * h * f.person.girth, -0.052 * h, 0]
    f.builder.panel(image, tuple(at), 0.12, 0.03, "+x")


def belt(f: Figure, color: Color = "black", wide: float = 0.101) -> None:
    rows = [f.ring(0.030, wide, 0.074), f.ring(0.055, wide - 0.002, 0.073)]
    f.builder.loft(rows, color, crease_deg=60)


def bands(f: Figure, color: Color, heights: tuple[float, ...], swell: float = 1.12) -> None:
    """Reflecting bands round the trunk, and round both forearms and shins."""
    rows = np.array([(0.0, 0.094, 0.066), (0.10, 0.090, 0.064), (0.2, 0.096, 0.066), (0.25, 0.108, 0.064)])
    for low in heights:
        wide, deep = (np.interp(low, rows[:, 0], rows[:, k]) * swell + 0.003 for k in (1, 2))
        f.builder.loft([f.ring(low, wide, deep), f.ring(low + 0.022, wide, deep)], color, crease_deg=60)
    h, g = f.person.height, f.person.girth**0.6
    for k in (0, 1):
        for start, end, radius in ((f.elbows[k], f.wrists[k], 0.031), (f.knees[k], f.ankles[k], 0.044)):
            a, b = start + 0.52 * (end - start), start + 0.68 * (end - start)
            f.builder.tube([a, b], radius * h * g, color, sides=8)


def cross_image(ground: Color, ink: Color) -> np.ndarray:
    image, pen = paint.canvas((96, 96), ground)
    pen.rectangle((38, 16, 58, 80), fill=paint.rgb(ink))
    pen.rectangle((16, 38, 80, 58), fill=paint.rgb(ink))
    return np.asarray(paint.shrunk(image, (24, 24)))


@recipe("doctor", 3, name="uniforms.doctor")
def doctor(variant: int, rng: np.random.Generator) -> BuiltAsset:
    person, pose = (
        (
            Person(1.70, 1.05, "skin dark", "short", "#15100d", "coat", "white", "trousers", "#2c2f3a", "black"),
            STANDING,
        ),
        (
            Person(1.80, 1.0, "skin medium", "short", "#1e1612", "shirt", "#2f8f86", "trousers", "#2f8f86", "white"),
            STEP,
        ),
        (
            Person(1.66, 0.97, "skin light", "bun", "#5a3820", "coat", "white", "trousers", "#39597a", "white"),
            Pose((3, -3), (4, 4), (8, 20), (14, 84), 0.0),
        ),
    )[variant]
    f = dressed(person, pose)
    b, h = f.builder, person.height
    loop = [f.trunk(z) + [x * h, y * h, 0] for x, y, z in _stethoscope(1.35 if variant != 1 else 1.0)]
    b.tube(loop, 0.007, "charcoal", sides=5)
    b.cylinder(0.024, 0.012, tuple(loop[-1]), "aluminium", (0, 90, 0), segments=10)
    if variant == 2:  # a clipboard on the forearm
        at = f.hands[1] + [0.02, 0.05, 0.05]
        b.box((0.012, 0.23, 0.32), tuple(at), "dark wood", turn_deg=(0, -38, 0), centered=True)
        b.box((0.006, 0.20, 0.28), tuple(at + [-0.006, 0, 0.006]), "white", turn_deg=(0, -38, 0), centered=True)
    if variant == 1:
        cap(f, "#2f8f86", "beanie")
    else:
        b.panel(cross_image("white", "red"), tuple(f.trunk(0.20) + [0.083 * h, -0.05 * h, 0]), 0.07, 0.07, "+x")
    names = ("A doctor in a white coat", "A surgeon in green scrubs", "A doctor in a white coat with a clipboard")
    size = ((0.34, 0.52, 1.72), (0.66, 0, 1.83), (0, 0, 1.67))[variant]
    return finished(f, names[variant], size)


def _stethoscope(out: float) -> list[tuple[float, float, float]]:
    return [
        (0.062 * out, 0.045, 0.20),
        (0.060 * out, 0.048, 0.27),
        (-0.01, 0.045, 0.325),
        (-0.045, 0.0, 0.33),
        (-0.01, -0.045, 0.325),
        (0.060 * out, -0.048, 0.27),
        (0.068 * out, -0.030, 0.16),
    ]


@recipe("emergency worker", 3, name="uniforms.emergency_worker")
def emergency_worker(variant: int, rng: np.random.Generator) -> BuiltAsset:
    jacket, trousers, stripe = (
        ("#c8d820", "dark green", "light grey"),
        ("safety orange", "#24385c", "signal yellow"),
        ("signal red", "#2a2d33", "light grey"),
    )[variant]
    person = Person(
        (1.77, 1.70, 1.84)[variant],
        (1.02, 0.97, 1.1)[variant],
        ("skin light", "skin dark", "skin medium")[variant],
        ("short", "bun", "short")[variant],
        ("#6a4526", "#15100d", "#2b1d15")[variant],
        "jacket",
        jacket,
        "trousers",
        trousers,
        "black",
    )
    f = dressed(person, (STANDING, STEP, STEP_OTHER)[variant])
    bands(f, stripe, (0.06, 0.15))
    badge_words(f, ("PARAMEDIC", "RESCUE", "MEDIC")[variant], "white", ("dark green", "#24385c", "#2a2d33")[variant])
    b = f.builder
    bag = ("signal red", "signal red", "signal yellow")[variant]
    x, y, z = f.hands[0]
    b.box((0.40, 0.20, 0.28), (x + 0.02, y + 0.05, z - 0.40), bag, bevel=0.04)
    b.box((0.404, 0.204, 0.03), (x + 0.02, y + 0.05, z - 0.27), "light grey")
    image = cross_image(bag, "white" if variant < 2 else "signal red")
    b.panel(image, (x + 0.224, y + 0.05, z - 0.315), 0.14, 0.14, "+x")
    b.panel(image, (x + 0.02, y + 0.153, z - 0.315), 0.14, 0.14, "+y")
    b.tube([(x - 0.1, y + 0.04, z - 0.13), (x - 0.05, y, z), (x + 0.08, y, z), (x + 0.13, y + 0.04, z - 0.13)], 0.012)
    if variant == 2:
        cap(f, "white", "helmet")
    names = ("A paramedic with a red bag", "A rescue worker with a first-aid bag", "A medic in a helmet with a bag")
    return finished(f, names[variant], ((0.42, 0.60, 1.77), (0, 0, 1.70), (0.77, 0, 1.88))[variant])


@recipe("firefighter", 3, name="uniforms.firefighter")
def firefighter(variant: int, rng: np.random.Generator) -> BuiltAsset:
    coat, stripe, hat = (
        ("#c2a25a", "lime", "signal red"),
        ("#23272f", "signal yellow", "signal yellow"),
        ("#8f2b22", "light grey", "white"),
    )[variant]
    person = Person(
        (1.78, 1.75, 1.82)[variant],
        (1.22, 1.15, 1.25)[variant],
        ("skin light", "skin dark", "skin medium")[variant],
        "bald" if variant else "short",
        "#3a2a1e",
        "jacket",
        coat,
        "trousers",
        coat,
        "black",
    )
    pose = (STANDING, STEP, Pose((4, -4), (5, 5), (12, 4), (60, 40), 1.0))
    f = dressed(person, pose[variant])
    bands(f, stripe, (0.03, 0.12, 0.20), 1.13)
    b, h = f.builder, person.height
    fire_helmet(f, hat)
    # Breathing set: a bottle on the back on its frame, straps, the regulator on the chest.
    back = f.trunk(0.03) - [0.125 * h, 0, 0]
    b.capsule(0.085, 0.50, tuple(back), "signal yellow" if variant != 1 else "grey", segments=10)
    b.box((0.05, 0.20, 0.40), tuple(back + [0.065, 0, 0.04]), "black", bevel=0.02)
    for side in (-1, 1):
        y = side * 0.055 * h
        strap = [f.trunk(z) + [x * h, y, 0] for z, x in ((0.28, -0.07), (0.315, 0.0), (0.26, 0.092), (0.12, 0.09))]
        b.tube(strap, 0.018, "black", sides=5)
    b.cylinder(0.035, 0.05, tuple(f.trunk(0.14) + [0.09 * h, 0.05 * h, 0]), "black", (0, 90, 0), segments=8)
    if variant == 2:  # a coil of hose on the shoulder side
        x, y, z = f.hands[0]
        for k in range(3):
            b.ring(0.17 - 0.02 * k, 0.035, (x + 0.02, y + 0.03 + 0.03 * k, z - 0.17), "#d8c9a0", (90, 0, 0), 14, 6)
    else:  # an axe
        x, y, z = f.hands[1]
        b.rod((x - 0.10, y, z - 0.28), (x + 0.10, y, z + 0.42), 0.018, "light wood", sides=6)
        blade = [(0.0, -0.06), (0.14, -0.11), (0.14, 0.09), (0.0, 0.05), (-0.10, 0.0)]
        with b.frame((x + 0.09, y, z + 0.38), (90, 0, 0)):
            b.extrude(blade, 0.025, (0, 0, -0.0125), "signal red")
    names = ("A firefighter with an axe", "A firefighter in dark turnout gear", "A firefighter carrying hose")
    return finished(f, names[variant], ((0.52, 0.66, 1.82), (0, 0, 1.80), (0.85, 0, 1.90))[variant])


def fire_helmet(f: Figure, color: Color) -> None:
    """A fire helmet: a high comb over the crown, a brim long at the back, a clear visor, a shield on the front."""
    rx, ry, rz = f.head_radii
    b = f.builder
    with b.frame(tuple(f.head_center + [-0.06 * rx, 0, 0.36 * rz]), (0, -4, f.pose.turn)):
        b.lathe(
            [(1.32 * rx, -0.10 * rz), (1.30 * rx, 0.25 * rz), (1.02 * rx, 0.68 * rz), (0.45 * rx, 0.92 * rz)],
            color=color,
            segments=14,
            crease_deg=60,
        )
        brim = [(1.75 * rx * np.cos(a) - 0.35 * rx, 1.55 * ry * np.sin(a)) for a in np.arange(14) * 2 * np.pi / 14]
        b.extrude(brim, 0.07 * rz, (0, 0, -0.12 * rz), shade(color, 0.8))
        b.box((1.7 * rx, 0.16 * ry, 0.22 * rz), (0, 0, 0.78 * rz), shade(color, 0.85), bevel=0.06 * rz)
        b.box(
            (0.10 * rx, 0.62 * ry, 0.60 * rz), (1.12 * rx, 0, 0.16 * rz), "gold", turn_deg=(0, -22, 0), taper=(1, 0.7)
        )


@recipe("gardener", 3, name="uniforms.gardener")
def gardener(variant: int, rng: np.random.Generator) -> BuiltAsset:
    person, pose = (
        (
            Person(1.66, 1.02, "skin light", "short", "#8a7a60", "shirt", "#b8503c", "trousers", "#3f5f3c", "#4a5a34"),
            Pose((6, -6), (6, 8), (6, 10), (16, 42), 3.0),
        ),
        (
            Person(1.64, 1.0, "skin medium", "long", "#2b1d15", "shirt", "#e6ddc8", "trousers", "#4a6a9a", "#6b4a2a"),
            STANDING,
        ),
        (
            Person(1.74, 1.1, "skin dark", "short", "#15100d", "shirt", "green", "trousers", "#6a5a40", "#3a2a1e"),
            Pose((24, -8), (30, 16), (40, 30), (26, 22), 28.0),
        ),
    )[variant]
    f = dressed(person, pose)
    b = f.builder
    apron = ("dark green", "#4f7a4a", "#c7a65a")[variant]
    if variant < 2:
        vest(f, apron, apron)
        b.loft([f.hem(-0.16, 0.105), f.ring(0.05, 0.100, 0.074)], apron, crease_deg=60)
    straw_hat(f, "#d8bd78", shade(apron, 0.8))
    x, y, z = f.hands[1]
    if variant == 1:  # a watering can
        b.lathe([(0.11, 0), (0.12, 0.02), (0.105, 0.22), (0.085, 0.25)], (x + 0.04, y - 0.02, z - 0.33), "teal")
        b.tube([(x + 0.12, y - 0.02, z - 0.26), (x + 0.36, y - 0.02, z - 0.02)], [0.025, 0.018], "teal", sides=8)
        with b.frame((x + 0.36, y - 0.02, z - 0.02), (0, 46, 0)):
            b.cylinder(0.02, 0.06, color="teal", top_radius=0.055, segments=10)
        grip = [(x - 0.06, y, z - 0.22), (x - 0.08, y, z - 0.02), (x + 0.06, y, z), (x + 0.10, y, z - 0.10)]
        b.tube(grip, 0.012, "teal")
    else:  # a rake with its teeth, or a spade
        foot = np.array([x + (0.03 if variant == 0 else 0.24), y + 0.01, 0.05])
        top = np.array([x, y, z]) + 0.45 * (np.array([x, y, z]) - foot) / np.linalg.norm([x, y, z] - foot)
        b.rod(tuple(top), tuple(foot), 0.016, "light wood", sides=6)
        if variant == 0:
            b.box((0.03, 0.32, 0.03), tuple(foot), "dark grey", centered=True)
            for k in range(7):
                b.box((0.012, 0.012, 0.07), (foot[0], foot[1] - 0.145 + 0.0483 * k, 0.0), "dark grey")
        else:
            b.box(
                (0.02, 0.20, 0.30), (foot[0] + 0.02, foot[1], 0.0), "galvanised", turn_deg=(0, -32, 0), taper=(1, 0.9)
            )
    names = ("A gardener with a rake and a straw hat", "A gardener with a watering can", "A gardener bent over a spade")
    return finished(f, names[variant], ((0.50, 0.61, 1.70), (0, 0, 1.72), (1.06, 0, 1.50))[variant])


def straw_hat(f: Figure, color: Color, ribbon: Color) -> None:
    rx, ry, rz = f.head_radii
    b = f.builder
    lean = 0.5 * f.pose.lean
    with b.frame(tuple(f.head_center + [-0.05 * rx, 0, 0.42 * rz]), (0, lean - 4, f.pose.turn)):
        b.lathe([(2.35 * ry, -0.12 * rz), (2.3 * ry, 0.0), (1.3 * ry, 0.06 * rz)], color=color, segments=18)
        b.lathe([(1.32 * ry, 0.0), (1.22 * ry, 0.62 * rz), (0.8 * ry, 0.76 * rz)], color=color, segments=14)
        b.cylinder(1.36 * ry, 0.18 * rz, (0, 0, 0.06 * rz), ribbon, segments=14, top_radius=1.30 * ry)


@recipe("maintenance worker", 3, name="uniforms.maintenance_worker")
def maintenance_worker(variant: int, rng: np.random.Generator) -> BuiltAsset:
    overall, top = (("#2c5aa0", "#2c5aa0"), ("#d8742a", "#d8742a"), ("#5a6068", "#b9452f"))[variant]
    person = Person(
        (1.75, 1.68, 1.82)[variant],
        (1.08, 1.0, 1.12)[variant],
        ("skin light", "skin dark", "skin medium")[variant],
        ("short", "bun", "short")[variant],
        ("#4a3524", "#15100d", "#2b1d15")[variant],
        "jacket" if variant == 1 else "shirt",
        top,
        "trousers",
        overall,
        "#3a2a1e",
    )
    f = dressed(person, (STANDING, STEP, Pose((3, -4), (4, 5), (10, 40), (16, 78), 2.0))[variant])
    b, h = f.builder, person.height
    cap(f, ("#2c5aa0", "signal yellow", "signal yellow")[variant], ("cap", "helmet", "helmet")[variant])
    belt(f, "#6b4423")
    for y, drop in ((0.098, 0.13), (-0.10, 0.15)):
        b.box((0.10, 0.05, drop), tuple(f.trunk(0.03) + [0.0, y * h * person.girth, -drop]), "#6b4423", bevel=0.01)
    if variant != 1:
        for side in (-1, 1):  # braces of the overall over the shirt
            brace = [f.trunk(z) + [x * h * person.girth, side * 0.05 * h, 0] for z, x in _BRACE]
            b.tube(brace, 0.016, shade(overall, 0.75), sides=4)
        chest = f.trunk(0.15) + [0.066 * h * person.girth, 0, 0]
        b.box((0.03, 0.16 * h * 0.9, 0.11 * h), tuple(chest), shade(overall, 0.9), centered=True, bevel=0.01)
    else:
        bands(f, "light grey", (0.06, 0.15))
    x, y, z = f.hands[0]
    box = ("signal red", "charcoal", "signal blue")[variant]
    b.box((0.36, 0.18, 0.17), (x + 0.02, y + 0.03, z - 0.25), box, bevel=0.015)
    b.box((0.364, 0.184, 0.02), (x + 0.02, y + 0.03, z - 0.14), "light grey")
    b.tube([(x - 0.09, y + 0.03, z - 0.08), (x - 0.07, y, z), (x + 0.10, y, z), (x + 0.12, y + 0.03, z - 0.08)], 0.012)
    x, y, z = f.hands[1]  # a large open-ended spanner
    b.rod((x - 0.05, y, z - 0.10), (x + 0.07, y, z + 0.16), 0.013, "aluminium", sides=6)
    half_jaw = [(-0.05, 0.0), (0.05, 0.0), (0.055, 0.08), (0.02, 0.08), (0.02, 0.04)]
    jaw = [*half_jaw, (-0.02, 0.04), (-0.02, 0.08), (-0.055, 0.08)]
    with b.frame((x + 0.07, y + 0.01, z + 0.15), (90, 25, 0)):
        b.extrude(jaw, 0.022, color="aluminium")
    names = ("A mechanic in a blue overall with a toolbox", "A utility worker in orange", "A technician with tools")
    return finished(f, names[variant], ((0.42, 0.58, 1.77), (0, 0, 1.72), (0, 0, 1.86))[variant])


_BRACE = ((0.12, 0.066), (0.26, 0.072), (0.312, 0.0), (0.24, -0.07), (0.06, -0.066))
