"""Roofs of regional buildings."""

import numpy as np

from ....meshes.palette import Color, mix, shade
from ..facade import Facade
from ..masonry import hip_roof
from . import panes
from .front import Front, arch, plate
from .styles import nth


def lay(front: Front, f: Facade) -> None:
    """Puts the roof of the building's kind on a facade."""
    KINDS[front.form.roof](front, f, nth(front.form.roof_colors, front.dressing))


def flat(front: Front, f: Facade, color: Color) -> None:
    f.course(f.height - 0.2, 0.2, 0.1, color)
    f.flat_roof(0.7)


def cornice(front: Front, f: Facade, color: Color) -> None:
    """A deep cornice on brackets."""
    b, w, x = f.builder, f.width, f.front
    f.cornice(f.height - 0.36, 0.5)
    for k in range(max(3, round(w / 0.8))):
        y = -w / 2 + 0.3 + (w - 0.6) * k / max(2, round(w / 0.8) - 1)
        b.box((0.34, 0.14, 0.3), (x + 0.16, y, f.height - 0.62), color)
    f.flat_roof(0.5)


def mansard(front: Front, f: Facade, color: Color) -> None:
    """Zinc and slate: a steep slope with dormers, a flat crown, chimneys with pots on the party walls."""
    f.cornice(f.height - 0.36, 0.42)
    rise = front.form.rise
    image = panes.pane("french", front.frame, front.tint, (24, 36))
    f.mansard(rise, color, front.bays(), image, inset=1.0)
    f.builder.box(
        (f.depth - 2.2, f.width - 0.6, 0.5), (0, 0, f.height + rise - 0.02), shade(color, 1.25), taper=(0.7, 1)
    )
    for side in (-1, 1):
        y = side * (f.width / 2 - 0.3)
        f.builder.box((2.4, 0.5, rise + 1.2), (0.3, y, f.height - 0.3), "#cbbd9d")
        for k in range(5):
            f.builder.cylinder(0.1, 0.4, (-0.6 + 0.45 * k, y, f.height + rise + 0.9), "terracotta", segments=6)


def _slopes(front: Front, f: Facade, color: Color, kind: str, overhang: float) -> None:
    """A pitched roof along the street whose front slope shows its tiles."""
    rise, h = front.form.rise, f.height
    f.gable_roof(rise, shade(color, 0.8), overhang, wall=front.color)
    half = f.depth / 2
    slope = rise / half
    x1, x0 = half + overhang + 0.04, 0.02
    run = f.width / 2 + overhang * 0.5 - 0.02
    ribs = 20 if kind == "tiles" else 24
    image = panes.tiled(kind, color, (128, 48), 8, ribs)
    lift = 0.14 + 0.03
    z1, z0 = h - (x1 - half) * slope + lift, h + rise + lift
    corners = [(x1, -run, z1), (x1, run, z1), (x0, run, z0), (x0, -run, z0)]
    f.builder.quad(corners, image=image)
    # The edge of the eaves, as thick as the tiles.
    f.builder.box((0.05, 2 * run, 0.16), (x1 - 0.04, 0, z1 - 0.17), shade(color, 0.72))
    f.builder.box((0.26, 2 * run, 0.2), (0, 0, z0 - 0.04), shade(color, 0.86))


def tiles(front: Front, f: Facade, color: Color) -> None:
    _slopes(front, f, color, "tiles", 0.5)


def eaves(front: Front, f: Facade, color: Color) -> None:
    """Dark tiles with deep eaves, and a second, narrow roof over the ground floor."""
    _slopes(front, f, color, "tiles", 0.75)
    g = front.form.ground_height
    if front.floors > 1:
        image = panes.tiled("tiles", color, (128, 24), 4, 24)
        w, x, reach = f.width / 2 - 0.02, f.front, 0.85
        corners = [(x + reach, -w, g - 0.42), (x + reach, w, g - 0.42), (x, w, g - 0.05), (x, -w, g - 0.05)]
        f.builder.quad(corners, image=image)
        with f.builder.frame((x, 0, g - 0.1)):
            f.builder.profile([(0.0, -0.12), (reach - 0.02, -0.42), (reach - 0.02, -0.34), (0.0, 0.03)], 2 * w,
                              color=shade(color, 0.7))  # fmt: skip


def hip(front: Front, f: Facade, color: Color) -> None:
    """Low hipped roof of sheets, well over the walls."""
    size = (f.depth + 1.2, f.width + 0.5, front.form.rise)
    f.builder.box((size[0], size[1], 0.14), (0, 0, f.height), shade(color, 0.75))
    hip_roof(f.builder, size, (0, 0, f.height + 0.14), color, 0.55)


def sheet(front: Front, f: Facade, color: Color) -> None:
    """Rusting sheets along the street."""
    _slopes(front, f, color, "sheet", 0.55)


def gabled(front: Front, f: Facade, color: Color) -> None:
    """A steep gable towards the street."""
    f.gable_roof(front.form.rise, color, 0.3, along=False, wall=front.color)
    image = panes.pane(front.form.window, front.frame, front.tint, (32, 40))
    f.builder.panel(image, (f.front + 0.02, 0, f.height + front.form.rise * 0.36), 0.95, 1.15)
    f.builder.box((0.08, 1.2, 0.08), (f.front + 0.03, 0, f.height + front.form.rise * 0.36 - 0.66), front.trim)
    for side in (-1, 1):  # white boards along the gable
        start = (f.front + 0.24, side * (f.width / 2 + 0.26), f.height - 0.3)
        f.builder.beam(start, (f.front + 0.24, 0, f.height + front.form.rise + 0.02), 0.06, 0.2, front.trim)


def dutch(front: Front, f: Facade, color: Color) -> None:
    """A stepped, neck or bell gable before a steep roof, with a hoisting beam."""
    h, w, rise = f.height, f.width, front.form.rise
    f.gable_roof(rise * 0.8, color, 0.05, along=False, wall=front.color)
    kind = ("bell", "step", "neck")[int(w * 2) % 3]
    half = w / 2
    if kind == "step":
        steps = 4
        outline = [(-half, h - 0.1)]
        for k in range(steps):
            y, z = half * (1 - k / steps), h + rise * (k + 1) / steps
            outline += [(-y, z - 0.0), (-y + half / steps * 0.999, z)]
        right = [(-y, z) for y, z in outline[::-1]]
        outline = outline[:-1] + right[1:]
    elif kind == "neck":
        n = half * 0.42
        outline = [
            (-half, h - 0.1),
            (-half, h + 0.35),
            (-n - 0.25, h + 0.5),
            (-n, h + rise * 0.55),
            (-n, h + rise * 0.85),
        ]
        outline += [(0, h + rise * 1.1)] + [(-y, z) for y, z in outline[::-1]]
    else:
        ts = np.linspace(0, 1, 7)
        left = [(-half + (half * 0.62) * float(t**0.6), h - 0.1 + rise * 0.95 * float(t**1.6)) for t in ts]
        outline = left + [(0, h + rise * 1.12)] + [(-y, z) for y, z in left[::-1]]
    plate(f.builder, outline[::-1], 0.3, f.front + 0.02, front.color)
    f.builder.box((0.16, w * 0.42, 0.16), (f.front, 0, h + rise * (0.86 if kind != "step" else 0.98)), "white")
    image = panes.pane("sash", front.frame, front.tint, (28, 44))
    f.builder.panel(image, (f.front + 0.04, 0, h + rise * 0.4), 0.95, 1.35)
    f.builder.box((1.0, 0.14, 0.16), (f.front + 0.4, 0, h + rise * 0.74), "dark wood")


def parapet(front: Front, f: Facade, color: Color) -> None:
    """A Victorian parapet with piers, urns and a raised middle."""
    b, w, x, h = f.builder, f.width, f.front, f.height
    f.cornice(h - 0.36, 0.35)
    b.box((0.3, w - 0.02, 0.75), (x - 0.16, 0, h), front.color)
    b.box((0.4, w, 0.1), (x - 0.14, 0, h + 0.75), front.trim)
    outline = [(-w * 0.22, h + 0.8), *arch(0, h + 1.2, w * 0.2, 0.55)[::-1], (w * 0.22, h + 0.8)]
    plate(b, outline[::-1], 0.26, x, front.color)
    for y in (-w / 2 + 0.2, -w * 0.22, w * 0.22, w / 2 - 0.2):
        b.box((0.4, 0.38, 1.15), (x - 0.16, y, h), front.trim)
        b.ball((0.17, 0.17, 0.2), (x - 0.16, y, h + 1.32), front.trim, segments=6, rings=4)
    f.flat_roof(0.3)


def mission(front: Front, f: Facade, color: Color) -> None:
    """A parapet with a strip of tiles."""
    f.flat_roof(0.6)
    image = panes.tiled("tiles", color, (128, 16), 2, 28)
    w, x, z = f.width / 2, f.front, f.height
    corners = [(x + 0.6, -w, z + 0.1), (x + 0.6, w, z + 0.1), (x - 0.1, w, z + 0.62), (x - 0.1, -w, z + 0.62)]
    f.builder.quad(corners, image=image)
    with f.builder.frame((x, 0, z)):
        f.builder.profile([(0.0, 0.0), (0.58, 0.0), (0.58, 0.09), (0.0, 0.5)], 2 * w - 0.02, color=shade(color, 0.7))


def crenels(front: Front, f: Facade, color: Color) -> None:
    """A parapet with a row of teeth."""
    f.flat_roof(0.9)
    count = max(4, round(f.width / 0.9))
    for k in range(count):
        y = -f.width / 2 + 0.3 + (f.width - 0.6) * k / (count - 1)
        f.builder.box((0.24, 0.4, 0.35), (f.front - 0.14, y, f.height + 0.88), color)


def terrace(front: Front, f: Facade, color: Color) -> None:
    """A flat roof with a stair head, a shed of sheets and a railing."""
    f.flat_roof(0.25)
    b, z = f.builder, f.height
    b.box((2.6, min(2.8, f.width * 0.5), 2.3), (-1.4, f.width * 0.16, z), mix(front.color, "concrete", 0.4))
    b.box((3.2, min(3.4, f.width * 0.6), 0.08), (-1.3, f.width * 0.16, z + 2.3), color)
    for py in np.linspace(-f.width / 2 + 0.15, f.width / 2 - 0.15, 5):
        b.box((0.05, 0.05, 0.75), (f.front - 0.12, float(py), z + 0.2), "galvanised")
    b.box((0.05, f.width - 0.2, 0.05), (f.front - 0.12, 0, z + 0.92), "galvanised")


def rebar(front: Front, f: Facade, color: Color) -> None:
    """An unfinished top: columns with bare rods that wait for another floor."""
    f.flat_roof(0.35)
    b, z = f.builder, f.height
    count = max(2, round(f.width / 3.2))
    for k in range(count + 1):
        y = -f.width / 2 + 0.3 + (f.width - 0.6) * k / count
        b.box((0.32, 0.32, 0.9), (f.front - 0.4, y, z), "concrete")
        for dy in (-0.1, 0.1):
            b.box((0.025, 0.025, 0.8), (f.front - 0.4, y + dy, z + 0.9), "rust")


KINDS = {
    "flat": flat,
    "cornice": cornice,
    "mansard": mansard,
    "tiles": tiles,
    "eaves": eaves,
    "hip": hip,
    "sheet": sheet,
    "gabled": gabled,
    "dutch": dutch,
    "parapet": parapet,
    "mission": mission,
    "crenels": crenels,
    "terrace": terrace,
    "rebar": rebar,
}
