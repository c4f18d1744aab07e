"""Park shelters and stages. The open side or the stage is at +x."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.recipe import recipe
from ..shared.facade_images import sign
from ..shared.outlines import arc
from ..shared.sizes import made


@recipe("shelter", 3, name="tents.shelter")
def shelter(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A timber one with a gabled roof and bench, a steel one with a curved glass roof, a hexagonal pavilion."""
    b = MeshBuilder(roughness=0.75)
    return (_timber_shelter, _steel_shelter, _pavilion)[variant % 3](b)


def _timber_shelter(b: MeshBuilder) -> BuiltAsset:
    """Six timber posts under a gabled roof, with a bench."""
    for x in (-1.2, 1.2):
        for y in (-1.8, 0.0, 1.8):
            b.box((0.14, 0.14, 2.2), (x, y, 0), "wood", bevel=0.012)
            if y:
                b.beam((x, y * 0.97, 1.75), (x, y * 0.76, 2.16), 0.08, 0.08, "wood")
        b.box((0.16, 3.9, 0.16), (x, 0, 2.16), "wood", bevel=0.012)
    for side in (-1, 1):
        roof = [(0, 2.9), (0, 2.82), (side * 1.55, 2.12), (side * 1.55, 2.2)]
        b.profile(roof, 4.2, color="terracotta")
        b.profile([(0, 2.82), (side * 1.1, 2.32), (0, 2.32)], 0.06, (0, side * 1.8, 0), "light wood")
    b.rod((0, -2.1, 2.88), (0, 2.1, 2.88), 0.06, "dark red", sides=8)
    for z in (0.5, 0.75, 1.0):
        b.box((0.04, 3.6, 0.18), (-1.2, 0, z), "light wood")
    b.box((0.42, 3.2, 0.06), (-0.95, 0, 0.42), "light wood", bevel=0.01)
    for y in (-1.3, 0, 1.3):
        b.box((0.3, 0.1, 0.42), (-0.95, y, 0), "wood")
    return made(b, "a timber shelter with a tiled roof", (3.1, 4.2, 2.9), style="timber")


def _steel_shelter(b: MeshBuilder) -> BuiltAsset:
    """Three steel posts under a curved glass roof, with a bench."""
    for y in (-1.4, 0, 1.4):
        b.box((0.1, 0.1, 2.3), (-0.75, y, 0), "charcoal", bevel=0.01)
        b.tube([(-0.75, y, 2.2), (0, y, 2.5), (0.85, y, 2.55)], 0.05, "charcoal")
    curve = [(-0.95, 2.12), (-0.6, 2.36), (0.0, 2.56), (0.6, 2.64), (1.0, 2.64)]
    b.profile([*curve, *[(x, z - 0.04) for x, z in reversed(curve)]], 3.3, color="light blue")
    for y in (-0.7, 0.7):
        b.box((0.02, 1.25, 1.5), (-0.75, y, 0.45), "glass")
        b.box((0.04, 1.3, 0.06), (-0.75, y, 1.95), "charcoal")
    b.box((0.36, 2.4, 0.05), (-0.5, 0, 0.45), "wood", bevel=0.01)
    for y in (-0.9, 0.9):
        b.box((0.3, 0.06, 0.45), (-0.5, y, 0), "charcoal")
    return made(b, "a steel shelter with a curved glass roof", (2.1, 3.3, 2.6), style="steel")


def _pavilion(b: MeshBuilder) -> BuiltAsset:
    """Six posts with railings on a base, under a roof with a lantern; one side is open."""
    angles = np.radians(np.arange(6) * 60 + 30)
    b.cylinder(2.3, 0.15, color="concrete", segments=6)
    for k, a in enumerate(angles):
        x, y = 1.95 * float(np.cos(a)), 1.95 * float(np.sin(a))
        b.cylinder(0.08, 2.3, (x, y, 0.15), "white", segments=10)
        if k:
            p = 1.95 * np.array([np.cos(angles[k - 1]), np.sin(angles[k - 1])])
            b.beam((p[0], p[1], 2.36), (x, y, 2.36), 0.08, 0.16, "white")
            if k not in (1,):
                b.beam((p[0], p[1], 0.95), (x, y, 0.95), 0.06, 0.06, "white")
                for s in np.linspace(0.15, 0.85, 5):
                    q = p + (np.array([x, y]) - p) * s
                    b.beam((q[0], q[1], 0.15), (q[0], q[1], 0.95), 0.03, 0.03, "white")
    b.lathe([(2.5, 2.4), (2.5, 2.46), (1.0, 3.2), (0.35, 3.5)], color="verdigris", segments=6, crease_deg=10)
    b.lathe([(0.35, 3.5), (0.32, 3.8), (0.45, 3.82), (0, 4.1)], color="verdigris", segments=6, crease_deg=10)
    b.ball(0.09, (0, 0, 4.15), "gold")
    return made(b, "a six-sided pavilion", (4.6, 5.0, 4.15), style="pavilion")


@recipe("stage", 3, name="tents.stage")
def stage(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A concert stage under a truss roof with screens and loudspeakers, a round-roofed band shell, a low fair stage."""
    b = MeshBuilder(roughness=0.7)
    if variant % 3 == 1:
        b.cylinder(4.4, 0.9, color="sandstone", segments=24)
        rows = []
        for s in np.linspace(0, 1, 7):
            r = 3.9 * (1 - 0.55 * s**1.6)
            rows.append([(-2.6 * s + 0.6, y, 0.9 + z) for y, z in arc(r, 0, 180, 15)])
        b.sheet(np.array(rows), "off white", both_sides=True)
        b.sheet(np.array([rows[-1], [(-2.05, y * 0.02, 0.92) for _, y, _ in rows[-1]]]), "cream", both_sides=True)
        b.tube(rows[0], 0.16, "verdigris", sides=8)
        for k in range(4):
            b.box((0.3, 2.4, 0.225 * (4 - k)), (4.1 + 0.3 * k, 0, 0), "granite")
        b.box((0.4, 0.5, 1.0), (1.5, 0, 0.9), "wood", taper=(0.8, 0.8))
        return made(b, "a band shell", (7.5, 9.5, 4.9), 0.5, style="band shell")
    wide, deep, top, roof = ((8.0, 6.0, 3.8, True), (5.0, 4.0, 3.2, False))[variant // 2]
    floor = 0.9 if roof else 0.6
    b.box((deep - 0.3, wide - 0.9, 0.15), (0, 0, floor - 0.15), "dark wood")
    b.box((0.03, wide - 0.9, floor - 0.15), (deep / 2 - 0.2, 0, 0), "black")
    for side in (-1, 1):
        b.box((deep - 0.3, 0.03, floor - 0.15), (0, side * (wide / 2 - 0.47), 0), "black")
    for k in range(3):
        b.box((0.28, 1.0, floor * (3 - k) / 4), (deep / 2 - 0.1 + 0.28 * k - 0.2, -wide * 0.36, 0), "aluminium")
    xs = (-deep / 2 + 0.25, deep / 2 - 0.25)
    ys = (-wide / 2 + 0.2, wide / 2 - 0.2)
    for x in xs if roof else xs[:1]:
        for y in ys:
            _truss(b, (x, y, 0.05), (x, y, top - 0.35))
            b.box((0.6, 0.4 if roof else 0.3, 0.06), (x, y, 0), "charcoal")
        _truss(b, (x, ys[0], top - 0.4), (x, ys[1], top - 0.4))
    if roof:
        arch = [(x, top - 0.35 + 0.32 * (1 - (2 * x / deep) ** 2)) for x in np.linspace(-deep / 2, deep / 2, 9)]
        b.profile([*arch, *[(x, z - 0.05) for x, z in reversed(arch)]], wide, color="charcoal")
    back = sign("LIVE TONIGHT" if roof else "TOWN FAIR", "purple" if roof else "signal red", "signal yellow", (160, 56))
    b.box((0.05, wide - 0.9, top - floor - 0.9), (xs[0] + 0.2, 0, floor + 0.3), "black", skins={"+x": back})
    for side in (-1, 1):
        for k in range(3 if roof else 2):
            x, y = deep / 2 - 0.75, side * (wide / 2 - 1.0)
            b.box((0.5, 0.55, 0.5), (x, y, floor + 0.52 * k), "black", bevel=0.02)
            b.cylinder(
                0.18, 0.012, (x + 0.245, y, floor + 0.52 * k + 0.25), "dark grey", turn_deg=(0, 90, 0), segments=14
            )
    for k in range(4):
        y = (k - 1.5) * wide * 0.18
        b.cylinder(
            0.09, 0.22, (xs[1 if roof else 0] + 0.05, y, top - 0.72), ("red", "blue", "amber", "green")[k], segments=10
        )
    b.rod((deep * 0.2, 0, floor), (deep * 0.2, 0, floor + 1.45), 0.018, "black", sides=6)
    b.rod((deep * 0.2, 0, floor + 1.4), (deep * 0.28, 0, floor + 1.55), 0.03, "dark grey", sides=8)
    b.cylinder(0.16, 0.02, (deep * 0.2, 0, floor), "black", segments=12)
    return made(b, "a concert stage" if roof else "a fair's stage", (deep, wide, top), 0.6, style="truss")


def _truss(b: MeshBuilder, start: tuple[float, float, float], end: tuple[float, float, float]) -> None:
    """A lattice girder of two chords with zigzag bars, 0.25 m deep."""
    a, c = np.array(start), np.array(end)
    off = np.array([0.0, 0.125, 0.0]) if abs(c[2] - a[2]) > 0.5 else np.array([0.0, 0.0, 0.125])
    for s in (-1, 1):
        b.rod(a + s * off, c + s * off, 0.028, "aluminium", sides=5)
    count = max(4, int(np.linalg.norm(c - a) / 0.55))
    zigzag = [a + (c - a) * k / count + (off if k % 2 else -off) for k in range(count + 1)]
    b.tube(zigzag, 0.016, "aluminium", sides=4)
