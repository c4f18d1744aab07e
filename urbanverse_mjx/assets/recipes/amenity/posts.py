"""Machines that stand alone on a pavement: hydrants, parking meters, chargers."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import rgb
from ...meshes.recipe import Physics, recipe

HYDRANT = Physics(
    ("cast iron",),
    2500.0,
    (45.0, 150.0),
    0.6,
    False,
    "a cast-iron pillar hydrant weighs 60-150 kg and is bolted to the main",
)


def _outlet(b: MeshBuilder, z: float, yaw: float, radius: float, reach: float, color: str, cap: str) -> None:
    with b.frame((0, 0, z), (0, 0, yaw)):
        b.cylinder(radius, reach, color=color, turn_deg=(0, 90, 0), segments=12)
        b.cylinder(radius * 1.25, 0.05, (reach - 0.01, 0, 0), cap, turn_deg=(0, 90, 0), segments=8)
        b.box((0.03, 0.035, 0.035), (reach + 0.05, 0, 0), cap, centered=True)


@recipe("fire hydrant", 4, HYDRANT, hulls=2, name="posts.fire_hydrant")
def fire_hydrant(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """North American barrels in three liveries and a slim European pillar."""
    b = MeshBuilder(roughness=0.45)
    color, cap = (("red", "white"), ("yellow", "blue"), ("red", "dark red"), ("light grey", "orange"))[variant % 4]
    h = float(rng.uniform(0.72, 0.82))
    if variant % 4 != 2:
        b.cylinder(0.17, 0.04, color=color, segments=20)
        for k in range(6):
            b.cylinder(
                0.014, 0.06, (0.145 * np.cos(k * 1.047), 0.145 * np.sin(k * 1.047), 0.01), "dark grey", segments=6
            )
        b.lathe([(0.12, 0.03), (0.105, 0.06), (0.1, h * 0.68)], color=color, segments=20)
        b.cylinder(0.145, 0.04, (0, 0, h * 0.66), color, segments=20)
        dome = [(0.13, h * 0.7), (0.12, h * 0.8), (0.085, h * 0.88), (0.04, h * 0.92), (0.03, h * 0.92), (0.03, h)]
        b.lathe(dome, color=cap if variant % 4 == 0 else color, segments=20)
        b.cylinder(0.028, 0.04, (0, 0, h * 0.97), cap, segments=5)
        _outlet(b, h * 0.52, 0.0, 0.075, 0.15, color, cap)
        for yaw in (90.0, -90.0):
            _outlet(b, h * 0.55, yaw, 0.05, 0.15, color, cap)
    else:
        h += 0.25
        b.cylinder(0.15, 0.05, color=color, segments=18)
        b.cylinder(0.075, h * 0.55, (0, 0, 0.04), color, segments=18)
        b.lathe([(0.09, h * 0.56), (0.12, h * 0.6), (0.12, h * 0.86), (0.09, h * 0.92), (0, h * 0.95)], color=color)
        b.cylinder(0.121, 0.04, (0, 0, h * 0.63), "white", segments=18)
        b.cylinder(0.03, h * 0.08, (0, 0, h * 0.93), cap, segments=5)
        for yaw in (35.0, -35.0):
            _outlet(b, h * 0.74, yaw, 0.05, 0.16, color, "aluminium")
    return b.build(f"a {color} fire hydrant with {cap} caps", {"color": color})


METER = Physics(
    ("steel", "plastic"),
    900.0,
    (8.0, 120.0),
    0.5,
    False,
    "single-space meter head 5-8 kg on a footed pipe; pay stations 60-120 kg",
)


@recipe("parking meter", 3, METER, hulls=2, name="posts.parking_meter")
def parking_meter(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Domed single-space meter, twin-headed meter, solar pay station."""
    b = MeshBuilder(roughness=0.4)
    style = ("single", "twin", "pay station")[variant % 3]
    screen, draw = paint.canvas((48, 40), "charcoal")
    draw.rectangle((6, 5, 42, 24), fill=rgb("light green"))
    paint.text(draw, "2:00", (8, 6, 40, 23), "black", bold=0.04)
    draw.rectangle((18, 31, 30, 34), fill=rgb("black"))
    if style != "pay station":
        h = float(rng.uniform(1.05, 1.2))
        b.cylinder(0.09, 0.02, color="dark grey")
        b.cylinder(0.03, h, color="galvanised", segments=12)
        color = "charcoal" if style == "single" else "blue"
        if style == "twin":
            b.beam((0, -0.12, h), (0, 0.12, h), 0.06, 0.06, color)
        for y in (0.0,) if style == "single" else (-0.12, 0.12):
            outline = [(-0.085, 0), (0.085, 0), (0.1, 0.17), (0.075, 0.26), (0.0, 0.3), (-0.075, 0.26), (-0.1, 0.17)]
            with b.frame((0, y, h)):
                b.extrude(outline, 0.12, (-0.06, 0, 0), color, turn_deg=(90, 0, 90))
                b.panel(screen, (0.062, 0, 0.17), 0.13, 0.11)
                b.box((0.012, 0.03, 0.05), (0.06, 0, 0.04), "aluminium")
        return b.build(f"a {style} parking meter", {"style": style})
    b.box((0.3, 0.36, 1.5), color="dark blue", bevel=0.02)
    b.box((0.34, 0.4, 0.04), color="dark grey")
    b.box((0.02, 0.3, 0.34), (0.15, 0, 1.02), "light grey")
    b.panel(screen, (0.162, 0.0, 1.24), 0.22, 0.16)
    b.box((0.02, 0.2, 0.12), (0.15, 0, 0.6), "charcoal")
    sign, draw = paint.canvas((48, 48), "signal blue")
    paint.text(draw, "P", (8, 5, 40, 43), "white", bold=0.05)
    b.panel(sign, (0.153, 0, 0.86), 0.22, 0.22)
    b.cylinder(0.03, 0.3, (0, 0, 1.5), "dark grey", segments=10)
    b.box((0.3, 0.4, 0.03), (0, 0, 1.8), "dark glass", turn_deg=(0, 20, 0))
    return b.build("a solar pay station", {"style": style})


CHARGER = Physics(
    ("steel", "plastic"),
    220.0,
    (30.0, 250.0),
    0.5,
    False,
    "a public AC charger weighs 30-60 kg, a fast charger 150-300 kg; both bolted down",
)


@recipe("charging station", 3, CHARGER, hulls=3, name="posts.charging_station")
def charging_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Round AC post, slab AC charger with cable, DC fast charger."""
    b = MeshBuilder(roughness=0.4)
    style = ("AC post", "AC slab", "DC fast")[variant % 3]
    body, trim = (("white", "green"), ("charcoal", "light blue"), ("off white", "teal"))[variant % 3]
    screen, draw = paint.canvas((48, 64), trim)
    paint.text(draw, "EV", (6, 4, 42, 26), "white", bold=0.05)
    draw.polygon([(28, 28), (14, 48), (23, 48), (19, 62), (35, 42), (26, 42)], fill=rgb("signal yellow"))
    b.box((0.5, 0.55, 0.06), color="concrete", bevel=0.01)
    with b.frame((0, 0, 0.06)):
        if style == "AC post":
            b.cylinder(0.13, 1.25, color=body, segments=22)
            b.cylinder(0.131, 0.05, (0, 0, 1.13), trim, segments=22)
            b.lathe([(0.13, 1.25), (0.11, 1.3), (0, 1.32)], color=body, segments=22)
            b.panel(screen, (0.133, 0, 0.92), 0.14, 0.19)
            sockets, reach, z = (-0.11, 0.11), 0.07, 0.7
        elif style == "AC slab":
            b.box((0.18, 0.4, 1.45), color=body, bevel=0.03)
            b.panel(screen, (0.092, 0, 1.2), 0.2, 0.27)
            b.box((0.01, 0.36, 0.03), (0.09, 0, 0.95), "light green")
            sockets, reach, z = (-0.2, 0.2), 0.03, 0.75
        else:
            b.box((0.4, 0.5, 1.85), color=body, bevel=0.04)
            b.box((0.02, 0.42, 0.7), (0.195, 0, 1.05), "charcoal")
            b.panel(screen, (0.207, 0, 1.45), 0.26, 0.34)
            b.box((0.42, 0.52, 0.1), (0, 0, 0.02), trim)
            b.box((0.3, 0.5, 0.03), (0.0, 0, 1.85), trim)
            sockets, reach, z = (-0.25, 0.25), 0.06, 1.0
        for y in sockets:
            side = float(np.sign(y))
            b.box((0.09, 0.06, 0.14), (reach, y, z), "charcoal", bevel=0.01)
            sag = [(reach + 0.03, y + side * 0.02 * k, z - 0.5 * np.sin(np.pi * k / 6)) for k in range(7)]
            b.tube(sag, 0.014, "black", sides=6)
    return b.build(f"a {style} charging station", {"style": style})
