"""Ground floors of regional buildings: shops behind timber fronts, glass or roller shutters, lattices, house doors."""

import itertools

import numpy as np

from ....meshes.palette import Color, mix, shade
from ...shared import facade_images as images
from ..facade import Facade, bays_over, stoop
from . import panes
from .front import Front, arch, plate, railing
from .styles import nth


def lay(front: Front, f: Facade) -> None:
    """Puts the ground floor of the building's kind on a facade."""
    KINDS[front.form.ground](front, f)


def arcade(front: Front, reach: float) -> None:
    """Piers, arches or a beam before a ground floor that stands back by `reach`, and a floor between."""
    b, form, g = front.builder, front.form, front.form.ground_height
    half, x = front.width / 2, front.main.front
    count = max(1, round(front.width / 3.6))
    b.box((reach - 0.02, front.width, 0.12), (x - reach / 2, 0, 0), "dark concrete")
    ys = [-half + 0.25 + (front.width - 0.5) * k / count for k in range(count + 1)]
    for y in ys:
        b.box((0.5, 0.5, g), (x - 0.25, y, 0), front.base)
        b.box((0.56, 0.58, 0.45), (x - 0.25, y, 0), shade(front.base, 0.86))
    for y0, y1 in itertools.pairwise(ys):
        a, c = y0 + 0.25, y1 - 0.25
        if form.arched:
            spring = g - 1.35
            opening = arch((a + c) / 2, spring, (c - a) / 2, 1.05)
            plate(b, [(a, g), *opening[::-1], (c, g)][::-1], 0.4, x - 0.02, front.color)
        else:
            b.box((0.3, c - a, 0.45), (x - 0.17, (a + c) / 2, g - 0.45), front.trim)


def _units(front: Front) -> tuple[list[float], float]:
    span = front.width - 0.3
    count = max(1, round(span / front.form.unit))
    return bays_over(count, span), span / count


def _sign(front: Front, f: Facade, y: float, width: float, number: int, entry: str) -> None:
    """A unit's sign above its opening, as the form says."""
    back, ink = front.board(number)
    sign, g = front.form.sign, front.form.ground_height
    if sign == "none":
        return
    tall = {"fascia": 0.62, "lightbox": 0.85, "painted": 0.75, "boards": 0.6, "wide": 1.0}[sign]
    if sign == "boards":  # each its own height and width
        width *= 0.72 + 0.25 * float(front.rng.random())
        tall *= 0.9 + 0.6 * float(front.rng.random())
    low = 2.72 if front.form.awning else 2.5
    tall = min(tall, g - 0.06 - low)
    out = {"fascia": 0.1, "lightbox": 0.32, "painted": 0.02, "boards": 0.12, "wide": 0.18}[sign]
    pixels = (112, max(14, min(40, round(112 * tall / width))))
    image = panes.sign(
        front.language, entry, back, ink, pixels, border=None if sign == "painted" else mix(back, ink, 0.5)
    )
    z = max(low, g - 0.12 - tall - (0.25 * float(front.rng.random()) if sign == "boards" else 0.0))
    f.builder.box((out, width - 0.12, tall), (f.front + out / 2, y, z), back, skins={"+x": image})


def _awning(front: Front, f: Facade, y: float, width: float) -> None:
    if front.form.awning:
        first = nth(front.form.awning, front.dressing)
        cloth = images.awning(first, "off white" if front.dressing == 1 else None, (64, 16), 10)
        f.awning(y, 2.68, width - 0.3, 1.0, cloth, 0.3)


def timber(front: Front, f: Facade) -> None:
    """Painted wood: pilasters, stall riser, a window and a glazed door under a fascia."""
    ys, width = _units(front)
    top = min(2.75, front.form.ground_height - 0.95)
    door = images.door(front.base, "glass", (28, 56))
    for k, y in enumerate(ys):
        trade, entry = next(front.shops)
        side = 1 if k % 2 else -1
        pane = panes.shop(trade, front.base, front.tint, (84, 56))
        f.opening(y + side * (width / 2 - 0.75), 0.04, 0.95, top, door, 0.35, sill=False)
        f.opening(y - side * 0.6, 0.55, width - 1.75, top - 0.51, pane, 0.12, sill=False)
        for edge in (-1, 1):
            at = (f.front + 0.02, y + edge * (width / 2 - 0.1), 0.0)
            f.builder.box((0.05, 0.22, front.form.ground_height - 0.2), at, shade(front.base, 0.85))
        f.builder.box((0.05, width - 1.7, 0.4), (f.front + 0.02, y - side * 0.6, 0.08), shade(front.base, 0.8))
        _sign(front, f, y, width, k, entry)
        _awning(front, f, y, width)
    f.course(front.form.ground_height - 0.1, 0.16, 0.16)


def shutters(front: Front, f: Facade) -> None:
    """Narrow shops, some open and some behind roller shutters, and a way up to the flats."""
    ys, width = _units(front)
    stair = len(ys) // 2 if len(ys) > 2 else -1
    for k, y in enumerate(ys):
        trade, entry = next(front.shops)
        if k == stair:
            f.opening(y, 0.06, 1.0, 2.2, images.door(shade(front.rail, 1.2), "panel", (24, 52)), 0.2, sill=False)
            f.opening(y, 2.5, 0.9, 0.6, panes.pane("single", front.frame, front.tint, (24, 20)), 0.1, sill=False)
            continue
        closed = front.rng.random() < 0.3
        tone: Color = ("#7f8f9c", "#5f7f63", "#8a6f5a", "#6d7f94", "#9a9c9e")[int(front.tint.integers(5))]
        image = panes.roller(tone, front.tint) if closed else panes.shop(trade, "charcoal", front.tint, (64, 48))
        f.opening(y, 0.06, width - 0.55, 2.35, image, 0.12 if closed else 0.45, sill=False)
        if not closed:
            f.builder.box((0.16, width - 0.5, 0.28), (f.front + 0.08, y, 2.42), tone)
            _awning(front, f, y, width)
        _sign(front, f, y, width, k, entry)


def glass(front: Front, f: Facade) -> None:
    """Glass from the pavement up, below lit sign boxes."""
    ys, width = _units(front)
    for k, y in enumerate(ys):
        trade, entry = next(front.shops)
        pane = panes.shop(trade, "aluminium", front.tint, (84, 52), warm=k % 2 == 0)
        f.opening(y, 0.12, width - 0.4, 2.35, pane, 0.2, sill=False)
        door = images.door("aluminium", "glass", (24, 56))
        side = 1 if k % 2 else -1
        f.builder.panel(door, (f.front - 0.15, y + side * (width / 2 - 0.8), 1.22), 0.95, 2.2)
        _sign(front, f, y, width, k, entry)
        _awning(front, f, y, width)


def doors(front: Front, f: Facade) -> None:
    """A house door with steps or a canopy, and windows beside it."""
    form = front.form
    bays = front.bays()
    at = len(bays) // 2
    leaf: Color = ("#5d3a24", "dark green", "#27435e")[front.dressing % 3]
    for k, y in enumerate(bays):
        if k == at:
            z = stoop(f, y, 1.5, 1)
            f.opening(y, z, 1.15, 2.3, images.door(leaf, "panel", (28, 56)), 0.25, sill=False)
            if form.hood != "":
                f.builder.box((0.5, 1.7, 0.12), (f.front + 0.24, y, z + 2.5), front.trim)
            continue
        image = panes.pane(form.window, front.frame, front.tint, (36, 48))
        low = max(0.9, min(form.sill, 1.2))
        f.opening(y, low, form.window_size[0], min(form.window_size[1], 1.7), image)
        if form.grille:
            railing(f.builder, f.front + 0.05, (y - form.window_size[0] / 2, y + form.window_size[0] / 2), low,
                    min(form.window_size[1], 1.7), front.rail)  # fmt: skip


def gate(front: Front, f: Facade) -> None:
    """A garage gate of bars, a door and a small window: the foot of a block of flats or a tube house."""
    half = front.width / 2
    steel: Color = front.rail
    wide = min(3.2, front.width * 0.5)
    f.opening(-half + 0.4 + wide / 2, 0.04, wide, 2.5, panes.roller(shade(steel, 1.2), front.tint), 0.15, sill=False)
    y = half - 1.0
    f.opening(y, 0.06, 1.0, 2.2, images.door(shade(steel, 0.9), "panel", (24, 52)), 0.2, sill=False)
    if front.width > 7.5:
        image = panes.pane(front.form.window, front.frame, front.tint, (36, 40))
        f.opening(half - 2.8, 1.0, 1.3, 1.3, image, 0.15)
    f.builder.box((0.4, front.width - 0.2, 0.12), (f.front + 0.2, 0, 2.75), front.trim)


def lattice(front: Front, f: Facade) -> None:
    """A townhouse's front of wooden lattices, a sliding door and a split curtain."""
    wood = front.frame
    half = front.width / 2
    door = (half - 1.5) * (1.0 if front.rng.random() < 0.5 else -1.0)
    side = 1.0 if door < 0 else -1.0
    _, entry = next(front.shops)
    f.opening(door, 0.05, 1.7, 2.05, panes.pane("lattice", wood, front.tint, (40, 48)), 0.3, sill=False)
    span = front.width - 3.2
    middle = side * (half - 0.35 - span / 2)
    f.opening(middle, 0.35, span, 1.85, panes.pane("lattice", wood, front.tint, (110, 44)), 0.08, sill=False)
    back, _ = front.board(0)
    for k in range(3):  # the curtain hangs in three cloths
        y = door + (k - 1) * 0.58
        corners = [(f.front + 0.05, y - 0.27, 1.45), (f.front + 0.05, y + 0.27, 1.45)]
        corners += [(f.front + 0.05, y + 0.27, 2.1), (f.front + 0.05, y - 0.27, 2.1)]
        f.builder.quad(corners, back, both_sides=True)
    image = panes.sign(front.language, entry, "dark wood", "off white", (72, 24))
    f.builder.box((0.08, 1.9, 0.6), (f.front + 0.1, door, 2.3), "dark wood", skins={"+x": image})
    f.builder.box((0.3, span, 0.3), (f.front + 0.15, middle, 0), "dark concrete")  # a stone foot


def strip(front: Front, f: Facade) -> None:
    """A one-storey shop of a strip: panes, a canopy and a parapet that carries the sign."""
    ys, width = _units(front)
    for k, y in enumerate(ys):
        trade, entry = next(front.shops)
        pane = panes.shop(trade, "aluminium", front.tint, (84, 52), warm=False)
        f.opening(y, 0.3, width - 0.6, 2.2, pane, 0.25, sill=False)
        back, ink = front.board(k)
        tall = min(1.15, f.height - 3.25)
        image = panes.sign(front.language, entry, back, ink, (112, max(18, round(112 * tall / (width * 0.8)))))
        f.builder.box((0.2, width * 0.8, tall), (f.front + 0.1, y, 3.1), back, skins={"+x": image})
    f.builder.box((1.0, front.width - 0.3, 0.18), (f.front + 0.5, 0, 2.75), front.trim)


def blank(front: Front, f: Facade) -> None:
    """A wall with a door and high slits, as of a villa behind its wall."""
    half = front.width / 2
    leaf: Color = ("#6b4a2a", "bronze", "#3b4a44")[front.dressing % 3]
    f.opening(half - 1.5, 0.06, 1.3, 2.5, images.door(leaf, "panel", (28, 56)), 0.25, sill=False)
    f.opening(-half + 2.3, 0.05, 3.0, 2.6, panes.roller(shade(leaf, 1.1), front.tint), 0.15, sill=False)
    for y in np.linspace(-half + 4.6, half - 3.0, max(1, int((front.width - 7) / 1.4))):
        f.opening(float(y), 1.7, 0.5, 1.1, panes.pane("single", front.frame, front.tint, (20, 36)), 0.18, sill=False)


KINDS = {
    "timber": timber,
    "shutters": shutters,
    "glass": glass,
    "doors": doors,
    "gate": gate,
    "lattice": lattice,
    "strip": strip,
    "blank": blank,
}
