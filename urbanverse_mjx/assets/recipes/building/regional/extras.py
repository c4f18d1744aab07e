"""Objects on regional fronts and roofs: air conditioners, tanks, dishes, wires, signs, washing."""

import numpy as np

from ....meshes.palette import Color, shade
from ..facade import Facade
from . import panes, words
from .front import Front


def lay(front: Front, f: Facade, base: float) -> None:
    """Puts the form's extras on a facade whose lowest upper floor is at height `base`."""
    for entry in front.form.extras:
        name, *number = entry.split()
        KINDS[name](front, f, base, float(number[0]) if number else 1.0)


def ac(front: Front, f: Facade, base: float, share: float) -> None:
    """Outdoor units of air conditioners below windows."""
    image = panes.machine_front()
    for level in range(front.floors - 1):
        for y in front.bays():
            if front.rng.random() < share:
                z = base + level * front.form.storey + 0.06
                y = y + (front.form.window_size[0] / 2 + 0.35) * (1 if front.rng.random() < 0.5 else -1)
                y = min(max(y, -f.width / 2 + 0.5), f.width / 2 - 0.5)
                f.builder.box((0.32, 0.78, 0.54), (f.front + 0.2, y, z), "off white", skins={"+x": image})


def tank(front: Front, f: Facade, base: float, number: float) -> None:
    """Water tanks on the roof."""
    color: Color = ("#23282c", "#2d5f9e", "#23282c")[front.dressing % 3]
    for k in range(int(number)):
        y = (k - (number - 1) / 2) * 1.7 + f.width * 0.15
        x = f.front - 1.1 - 0.4 * (k % 2)
        f.builder.box((1.2, 1.2, 0.5), (x, y, f.height), "concrete")
        f.builder.lathe([(0.55, 0.0), (0.58, 0.9), (0.5, 1.15), (0.2, 1.3), (0.0, 1.32)], (x, y, f.height + 0.5), color,
                        segments=10)  # fmt: skip


def dish(front: Front, f: Facade, base: float, number: float) -> None:
    """Satellite dishes along the roof's edge."""
    for k in range(int(number)):
        y = -f.width / 2 + f.width * (k + 0.6) / (number + 0.4)
        x, z = f.front - 0.5, f.height + 0.2
        f.builder.rod((x, y, z), (x, y, z + 0.9), 0.03, "galvanised", sides=4)
        profile = [(0.0, 0.0), (0.25, 0.05), (0.42, 0.16), (0.4, 0.18), (0.22, 0.08), (0.0, 0.04)]
        f.builder.lathe(profile, (x, y, z + 0.9), "light grey", (0, 60, 25), segments=9)


def wires(front: Front, f: Facade, base: float, number: float) -> None:
    """Cables along the wall above the ground floor, with a box now and then."""
    steps = np.linspace(-f.width / 2 + 0.02, f.width / 2 - 0.02, 7)
    for k in range(int(number)):
        z = base + 0.22 + 0.1 * k
        path = [(f.front + 0.07 + 0.03 * k, float(y), z - 0.05 * (i % 2) * (1 + k % 3)) for i, y in enumerate(steps)]
        f.builder.tube(path, 0.012, "charcoal", sides=3)
    f.builder.box((0.16, 0.34, 0.44), (f.front + 0.1, f.width * 0.22, base + 0.1), "light grey")


def pipe(front: Front, f: Facade, base: float, number: float) -> None:
    """Downpipes at the edges."""
    for side in (-1, 1):
        y = side * (f.width / 2 - 0.14)
        f.builder.box((0.09, 0.09, f.height - 0.5), (f.front + 0.06, y, 0.1), shade(front.trim, 0.75))


def laundry(front: Front, f: Facade, base: float, share: float) -> None:
    """Washing on lines below windows."""
    colors: tuple[Color, ...] = ("white", "light blue", "red", "off white", "pink", "teal", "yellow")
    for level in range(1, front.floors - 1):
        for y in front.bays():
            if front.rng.random() < share:
                z = base + level * front.form.storey + front.form.sill * 0.5 - 0.1
                x = f.front + (1.12 if front.form.balcony and not front.form.balcony.startswith("guard") else 0.35)
                for k in range(4):
                    py, tall = y - 0.6 + 0.4 * k, 0.4 + 0.3 * float(front.rng.random())
                    corners = [(x, py - 0.15, z - tall), (x, py + 0.15, z - tall), (x, py + 0.15, z), (x, py - 0.15, z)]
                    f.builder.quad(corners, colors[int(front.tint.integers(len(colors)))], both_sides=True)


def blade(front: Front, f: Facade, base: float, number: float) -> None:
    """A square sign that stands out from the wall."""
    trade, entry = next(front.shops)
    back, ink = front.board(1)
    if trade == "health":
        back, ink = "white", "green"
    image = panes.sign(front.language, words.lines(entry)[0], back, ink, (48, 30), border=ink)
    size, y = 0.95, f.width / 2 - 0.5
    x = f.front + 0.1 + size / 2
    f.builder.box((size, 0.1, 0.6), (x, y, base - 0.35), back, skins={"+y": image, "-y": image})
    f.builder.rod((f.front, y, base + 0.2), (x, y, base + 0.2), 0.02, "black", sides=4)


def upright(front: Front, f: Facade, base: float, number: float) -> None:
    """Tall signs at right angles to the wall, one above another; letters in a column where the script allows it."""
    for k in range(int(number)):
        _, entry = next(front.shops)
        back, ink = front.board(k)
        column = words.can_stand(front.language)
        image = panes.sign(front.language, entry, back, ink, (24, 84) if column else (84, 40), upright=column)
        size = (0.75, 0.16, 2.5) if column else (1.2, 0.16, 0.7)
        side = 1 if k % 2 == 0 else -1
        z = base - 0.1 + (k // 2) * (size[2] + 0.15)
        if z + size[2] > f.height + 0.4:
            break
        at = (f.front + 0.1 + size[0] / 2, side * (f.width / 2 - 0.35), z)
        f.builder.box(size, at, back, skins={"+y": image, "-y": image})


def boards(front: Front, f: Facade, base: float, number: float) -> None:
    """Signs over the windows of the upper floors, as many as it has shops there."""
    for k in range(int(number)):
        if k >= front.floors - 1:
            break
        _, entry = next(front.shops)
        back, ink = front.board(k + 1)
        wide, tall = f.width * (0.5 if k % 2 else 0.72), 0.62
        image = panes.sign(front.language, entry, back, ink, (112, max(14, round(112 * tall / wide))))
        z = base + (k + 1) * front.form.storey - 0.68
        at = (f.front + 0.1, (f.width - wide) / 2 * (1 if k % 2 else -1) * 0.7, z)
        f.builder.box((0.2, wide, tall), at, back, skins={"+x": image})


def lanterns(front: Front, f: Facade, base: float, number: float) -> None:
    """Paper lanterns under the eaves."""
    for k in range(int(number)):
        y = -f.width / 2 + f.width * (k + 0.5) / number
        z = base - 0.75
        f.builder.lathe([(0.08, 0.0), (0.19, 0.1), (0.19, 0.36), (0.08, 0.46)], (f.front + 0.45, y, z), "#c3342b",
                        segments=8)  # fmt: skip
        f.builder.cylinder(0.08, 0.04, (f.front + 0.45, y, z + 0.46), "black", segments=6)


def antenna(front: Front, f: Facade, base: float, number: float) -> None:
    """Aerials on the roof."""
    for k in range(int(number)):
        y = (k - (number - 1) / 2) * 2.5
        b, x, z = f.builder, -0.4, f.height + 0.4
        b.box((0.04, 0.04, 2.2), (x, y, z), "galvanised")
        for j in range(4):
            b.box((0.03, 0.9 - 0.15 * j, 0.03), (x, y, z + 1.2 + 0.26 * j), "galvanised")


def machines(front: Front, f: Facade, base: float, number: float) -> None:
    """Boxes of air conditioning on the roof."""
    for k in range(int(number)):
        f.builder.box((1.5, 1.7, 1.1), (-0.5, (k - (number - 1) / 2) * 2.6, f.height), "galvanised", bevel=0.05)


def canopy(front: Front, f: Facade, base: float, reach: float) -> None:
    """A flat awning over the pavement on rods, with the shops' names along its edge."""
    z, w = base - 0.75, f.width - 0.06
    f.builder.box((reach, w, 0.12), (f.front + reach / 2, 0, z), "light grey")
    back, ink = front.board(0)
    _, entry = next(front.shops)
    image = panes.sign(front.language, entry, back, ink, (128, max(10, round(128 * 0.5 / w))))
    f.builder.box((0.08, w, 0.5), (f.front + reach, 0, z - 0.12), back, skins={"+x": image})
    for y in (-w / 3, w / 3):
        f.builder.rod((f.front, y, z + 1.3), (f.front + reach * 0.9, y, z + 0.12), 0.02, "black", sides=4)


def flowers(front: Front, f: Facade, base: float, share: float) -> None:
    """Boxes of geraniums on sills."""
    for level in range(front.floors - 1):
        for y in front.bays():
            if front.rng.random() < share:
                z = base + level * front.form.storey + front.form.sill - 0.05
                wide = front.form.window_size[0]
                f.builder.box((0.22, wide, 0.2), (f.front + 0.14, y, z), "terracotta")
                f.builder.box((0.3, wide * 0.96, 0.2), (f.front + 0.16, y, z + 0.18), "leaf", taper=(0.6, 0.9))
                f.builder.box(
                    (0.34, wide * 0.9, 0.07), (f.front + 0.18, y, z + 0.3), ("#c0304a", "pink")[front.dressing % 2]
                )


KINDS = {
    "ac": ac,
    "tank": tank,
    "dish": dish,
    "wires": wires,
    "pipe": pipe,
    "laundry": laundry,
    "blade": blade,
    "upright": upright,
    "boards": boards,
    "lanterns": lanterns,
    "antenna": antenna,
    "machines": machines,
    "canopy": canopy,
    "flowers": flowers,
}
