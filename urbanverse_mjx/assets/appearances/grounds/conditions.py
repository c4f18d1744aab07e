"""Effects of weather, traffic and time: each condition takes a surface and returns one."""

import dataclasses

import numpy as np

from .bases import Colour, toned
from .board import Board, Field, mix, smoothstep
from .layouts import cells
from .surface import Surface


def cracked(surface: Surface, board: Board, count: int = 4, width_m: float = 0.006, length_m: float = 1.6) -> Surface:
    """Cracks that wander and fork."""
    lines = board.streaks(count, length_m)
    line = np.clip(
        board.blur(lines, max(width_m / 2.4, 0.45 * board.pixel)) * 2.6 * max(width_m / board.pixel, 1), 0, 1
    )
    soft = board.blur(lines, width_m * 2.5) * 5 * width_m / board.pixel
    colour = mix(surface.colour, surface.colour * 0.30, line * 0.85)
    colour = colour * (1.0 - 0.22 * np.clip(soft, 0, 1))[..., None]
    return dataclasses.replace(
        surface, colour=colour, height=surface.height - 0.005 * line, joint=np.maximum(surface.joint, line)
    )


def alligatored(surface: Surface, board: Board, share: float = 0.3) -> Surface:
    """A net of cracks over a share of the tile: fatigue of the layers below."""
    across = round(board.metres / 0.16)
    net = cells(board, across, across, 0.95, bend=0.02, bend_scale=0.12)
    where = board.share(board.noise(1.6, 2.6), share, 0.7)
    width = 0.005 * (0.6 + 0.5 * board.blur((board.noise(0.4) > 0.2) * 1.0, 0.01))
    line = np.clip((width - net.edge) / board.pixel + 0.6, 0.0, 1.0) * where
    colour = mix(surface.colour, surface.colour * 0.34, line * 0.9) * (1.0 - 0.07 * where)[..., None]
    return dataclasses.replace(
        surface, colour=colour, height=surface.height - 0.004 * line, joint=np.maximum(surface.joint, line)
    )


def sealed(surface: Surface, board: Board, count: int = 3) -> Surface:
    """Cracks sealed with bitumen: black, smooth bands that follow the cracks."""
    lines = board.streaks(count, 2.6, branches=0.10, wander=0.16)
    field = board.blur(lines, 0.016) * 0.016 / board.pixel
    band = smoothstep((field - 0.10 + 0.02 * board.noise(0.2)) / 0.08)
    tar = toned((0.135, 0.135, 0.14), 0.06 * board.grain(0.006))
    return dataclasses.replace(
        surface,
        colour=mix(surface.colour, tar, band * 0.95),
        height=surface.height * (1 - 0.7 * band) + 0.0015 * band,
        roughness=mix(surface.roughness, 0.5, band),
    )


def patched(surface: Surface, board: Board, patch: Surface, count: int = 2, sealed_edge: bool = True) -> Surface:
    """Rectangles of another surface, as trenches and holes are fixed."""
    for _ in range(count):
        across, down = board.rng.uniform(0.16, 0.42, 2) * board.metres * np.array([1.0, 0.75])
        cx, cy = board.rng.random(2) * board.metres
        # The shortest path round the tile.
        dx = np.abs((board.x - cx + board.metres / 2) % board.metres - board.metres / 2)
        dy = np.abs((board.y - cy + board.metres / 2) % board.metres - board.metres / 2)
        inside = np.minimum(across / 2 - dx, down / 2 - dy) + 0.006 * board.noise(0.3)
        cover = np.clip(inside / board.pixel + 0.5, 0.0, 1.0)
        shade = np.float32(board.rng.uniform(0.9, 1.08))
        seam = np.clip(1.0 - np.abs(inside) / (0.02 if sealed_edge else 0.005), 0.0, 1.0)
        colour = mix(surface.colour, patch.colour * shade, cover)
        colour = mix(colour, (0.14, 0.14, 0.145) if sealed_edge else colour * 0.55, smoothstep(seam * 1.6) * 0.85)
        surface = Surface(
            colour,
            mix(surface.height, patch.height + 0.002, cover) - (0.0 if sealed_edge else 0.003) * seam,
            mix(mix(surface.roughness, patch.roughness, cover), 0.55 if sealed_edge else 0.9, seam * 0.8),
            surface.joint * (1 - cover),
            surface.unit,
        )
    return surface


def worn(surface: Surface, board: Board, amount: float = 0.5) -> Surface:
    """Polished and scuffed: paler where feet and wheels go, chipped rims, dirt in the pores."""
    trodden = board.noise(1.2, 2.4)
    scuff = board.noise(0.12, 1.2)
    chipped = board.share(board.noise(0.06, 1.6) + 1.3 * board.blur(surface.joint, 0.012) * 3, 0.03 * amount, 0.25)
    colour = toned(surface.colour, amount * (0.05 * np.tanh(trodden) + 0.045 * scuff))
    grey = colour.mean(-1, keepdims=True)
    colour = colour + (grey - colour) * 0.22 * amount
    colour = mix(colour, colour * 0.72, chipped)
    return dataclasses.replace(
        surface,
        colour=colour,
        height=surface.height - 0.002 * chipped,
        roughness=np.clip(surface.roughness - 0.12 * amount * smoothstep(trodden * 0.5 + 0.3), 0.3, 1.0),
    )


def stained(surface: Surface, board: Board, amount: float = 0.5) -> Surface:
    """Drips of oil, chewing gum trodden flat, rings of rust and grime."""
    spots = board.share(board.grain(0.13) + 0.35 * board.grain(0.03), 0.05 * amount, 1.6)
    gum = board.share(board.grain(0.035), 0.006 * amount + 0.001, 0.2)
    grime = board.share(board.noise(0.9, 2.2), 0.25, 1.0) * amount
    colour = surface.colour * (1.0 - 0.22 * spots - 0.12 * grime)[..., None]
    colour = mix(colour, colour * 0.55 + 0.05, gum * 0.8)
    return dataclasses.replace(surface, colour=colour, roughness=surface.roughness - 0.12 * spots)


def tracked(surface: Surface, board: Board) -> Surface:
    """A traffic lane across the tile: two polished wheel paths along u, oil between them."""
    across = board.y / board.metres + 0.008 * board.noise(1.5, 3.0)
    wheel = np.exp(-(((across - 0.27) / 0.075) ** 2)) + np.exp(-(((across - 0.73) / 0.075) ** 2))
    oil = np.exp(-(((across - 0.5) / 0.09) ** 2))
    wheel, oil = wheel * (1 + 0.15 * board.noise(0.8)), oil * (1 + 0.35 * board.noise(0.6))
    return dataclasses.replace(
        surface,
        colour=surface.colour * (1 + 0.11 * wheel - 0.20 * np.clip(oil, 0, 1.5))[..., None],
        roughness=np.clip(surface.roughness - 0.14 * wheel, 0.3, 1.0),
    )


def mossy(surface: Surface, board: Board, share: float = 0.5) -> Surface:
    """Moss and weeds: first in the joints and cracks, then round them."""
    near = np.clip(board.blur(surface.joint, 0.010) * 1.8, 0.0, 1.0)
    where = near * 2.2 + 0.9 * board.noise(0.5, 2.2) + 0.5 * board.grain(0.012)
    cover = board.share(where, share * 0.30, 0.5)
    tuft = board.grain(0.007)
    green = mix(toned((0.26, 0.31, 0.13), 0.22 * tuft), (0.42, 0.43, 0.20), smoothstep(board.noise(0.4) * 0.5 + 0.4))
    return dataclasses.replace(
        surface,
        colour=mix(surface.colour, green, cover * 0.88),
        height=surface.height + cover * (0.004 + 0.002 * tuft),
        roughness=mix(surface.roughness, 1.0, cover),
    )


def wet(surface: Surface, board: Board, amount: float = 1.0) -> Surface:
    """A film of water: light is caught under it, so pores darken (Lekner and Dorf 1988: albedo 0.2 falls to 0.12,
    a factor of 0.8 in sRGB), colours deepen, and the top shines."""
    film = np.clip(amount + 0.25 * board.noise(0.9, 2.4), 0.0, 1.0)
    grey = surface.colour.mean(-1, keepdims=True)
    deep = (grey + (surface.colour - grey) * 1.25) * 0.70
    return dataclasses.replace(
        surface,
        colour=np.clip(mix(surface.colour, deep, film), 0.0, 1.0),
        roughness=mix(surface.roughness, np.clip(0.30 + 0.25 * (surface.roughness - 0.8), 0.2, 0.4), film),
    )


def puddled(surface: Surface, board: Board, share: float = 0.22) -> Surface:
    """A wet surface with standing water in its low parts, which is level, dark and smooth."""
    surface = wet(surface, board, 0.8)
    low = -board.noise(1.4, 4.0) - np.clip(surface.height / 0.006, -1.5, 1.5) * 0.12
    water = board.share(low, share, 0.12)
    shore = board.share(low, share + 0.06, 0.35)
    colour = surface.colour * (1.0 - 0.12 * shore)[..., None]
    colour = mix(colour, colour * 0.62 * np.array([0.96, 1.0, 1.04], np.float32), water)
    return dataclasses.replace(
        surface,
        colour=colour,
        height=mix(surface.height, 0.0, water),
        roughness=mix(surface.roughness, 0.05, water),
    )


def snowy(surface: Surface, board: Board, share: float, dirty: float = 0.0, tracks: bool = False) -> Surface:
    """Snow over a share of the tile, first in joints and hollows, with wheel tracks of slush."""
    field = board.noise(1.0, 3.5) - np.clip(surface.height / 0.004, -1.5, 1.5) * 0.3 + 0.12 * board.grain(0.04)
    if tracks:
        across = board.y / board.metres + 0.006 * board.noise(1.2, 3.0)
        wheel = np.exp(-(((across - 0.28) / 0.07) ** 4)) + np.exp(-(((across - 0.72) / 0.07) ** 4))
        field = field - 2.4 * wheel
    cover = board.share(field, share, 0.9)
    thick = board.blur(cover, 0.03)
    clump = board.noise(0.16, 2.2)
    white = toned((0.90, 0.92, 0.955), 0.022 * clump, 0.018 * board.grain(0.008))
    grime = np.clip(dirty * (0.6 + 0.5 * board.noise(0.5, 2.0)) + 0.25 * (1 - thick), 0.0, 0.85)
    white = mix(white, (0.55, 0.53, 0.51), grime * (0.4 + 0.6 * dirty))
    damp = np.clip(thick * 2.5 + 0.3, 0.0, 1.0)
    base = wet(surface, board, 0.9)
    colour = mix(mix(surface.colour, base.colour, damp), white, cover)
    return dataclasses.replace(
        surface,
        colour=colour,
        height=mix(surface.height, 0.012 * thick + 0.0012 * clump, cover),
        roughness=mix(mix(surface.roughness, base.roughness, damp), 0.9 - 0.25 * dirty, cover),
    )


def icy(surface: Surface, board: Board, share: float = 0.5) -> Surface:
    """Frozen film: greyish, glassy patches with white rims."""
    surface = wet(surface, board, 0.7)
    field = board.noise(0.9, 3.0)
    ice = board.share(field, share, 1.1)
    frost = board.share(board.noise(0.08, 1.6) + 2.0 * ice * (1 - ice) * 4, 0.2, 0.5)
    colour = mix(surface.colour, (0.62, 0.66, 0.70), ice * 0.42)
    colour = mix(colour, (0.84, 0.87, 0.90), frost * 0.35)
    return dataclasses.replace(
        surface,
        colour=colour,
        height=mix(surface.height, 0.001, ice),
        roughness=mix(mix(surface.roughness, 0.75, frost * 0.6), 0.08, ice * (1 - 0.5 * frost)),
    )


def sanded(surface: Surface, board: Board, share: float = 0.35, colour: Colour = (0.66, 0.57, 0.43)) -> Surface:
    """Blown sand and dust: a thin layer everywhere, more in the low parts."""
    drift = board.noise(1.0, 2.2) - surface.height / 0.004 * 0.4
    cover = np.clip(board.share(drift, share, 2.2) * 0.8 + 0.12, 0.0, 1.0)
    sand = toned(colour, 0.06 * board.grain(0.005), 0.04 * board.noise(0.3))
    return dataclasses.replace(
        surface,
        colour=mix(surface.colour, sand, cover),
        height=mix(surface.height, surface.height * 0.4 + 0.001, cover),
        roughness=mix(surface.roughness, 0.97, cover),
    )


def painted(surface: Surface, board: Board, paint: Colour, wear: float = 0.2) -> Surface:
    """A coat of coloured paint over the whole tile (bicycle lanes, squares), worn off on the high spots."""
    rubbed = board.noise(0.9, 1.8) + 0.6 * board.grain(0.012) + surface.height / 0.002 * 0.3
    gone = board.share(rubbed, wear, 0.5)
    coat = toned(paint, 0.03 * board.noise(0.8), 0.03 * board.grain(0.01))
    coat = coat * (0.72 + 0.28 * np.clip(surface.colour.mean(-1) / surface.colour.mean(), 0.4, 1.4))[..., None]
    keep = (1.0 - gone) * (1.0 - 0.85 * surface.joint)
    return dataclasses.replace(
        surface, colour=mix(surface.colour, coat, keep), roughness=mix(surface.roughness, 0.7, keep)
    )


def leaf_strewn(surface: Surface, board: Board, per_m2: float, colours: tuple[Colour, ...], size_m: float) -> Surface:
    """Fallen leaves: pointed blades with a midrib, turned and curled at random, each casting a soft shade."""
    colour, height, rough = surface.colour.copy(), surface.height.copy(), surface.roughness.copy()
    for _ in range(int(per_m2 * board.metres**2)):
        length = size_m * board.rng.uniform(0.65, 1.25)
        reach = int(np.ceil(length * 0.62 / board.pixel)) + 2
        at = board.rng.integers(0, board.size, 2)
        rows, columns = (at[0] + np.arange(-reach, reach + 1)), (at[1] + np.arange(-reach, reach + 1))
        place = np.ix_(rows % board.size, columns % board.size)
        dy, dx = np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1), indexing="ij")
        angle = board.rng.uniform(0, 2 * np.pi)
        along = (np.cos(angle) * dx + np.sin(angle) * dy) * board.pixel / (length / 2)
        across = (np.cos(angle) * dy - np.sin(angle) * dx) * board.pixel / (length / 2)
        cover, rib = _leaf(along, across, board.rng.uniform(0.42, 0.7), board.pixel / (length / 2))
        tone = np.asarray(colours[board.rng.integers(len(colours))]) * board.rng.uniform(0.75, 1.15)
        curl = 1.0 + 0.25 * across * board.rng.choice([-1, 1])
        blade = tone * (curl - 0.18 * rib)[..., None]
        shade = np.roll(cover, (1, 1), (0, 1)) * (1 - cover)
        piece = colour[place] * (1 - 0.35 * shade)[..., None]
        colour[place] = piece + (blade - piece) * cover[..., None]
        height[place] = height[place] + cover * (0.003 + 0.004 * across * (curl - 1))
        rough[place] = rough[place] + (0.7 - rough[place]) * cover
    return dataclasses.replace(surface, colour=np.clip(colour, 0, 1), height=height, roughness=rough)


def _leaf(along: Field, across: Field, width: float, pixel: float) -> tuple[Field, Field]:
    """Cover and midrib of a leaf from -1 to 1 along its axis, in half lengths; `pixel` in the same unit."""
    outline = width * np.clip(1 - along**2, 0, 1) ** 0.8 * (0.80 + 0.20 * np.cos(9 * along)) * (1 - 0.25 * along)
    cover = np.clip((outline - np.abs(across)) / pixel + 0.5, 0.0, 1.0) * (np.abs(along) < 1)
    stalk = (np.abs(across) < 0.7 * pixel) & (along < -0.85) & (along > -1.25)
    return np.maximum(cover, stalk * 0.8), np.clip(1 - np.abs(across) / (1.2 * pixel), 0, 1) * (np.abs(along) < 0.9)
