"""Security guards and traffic controllers."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset
from ...meshes.recipe import recipe
from .figure import STANDING, Person, Pose
from .uniforms import STEP, badge_words, belt, dressed, finished
from .worn_items import backpack, cap, vest


@recipe("security guard", 3, name="guards.security_guard")
def security_guard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    person = Person(
        (1.78, 1.72, 1.86)[variant],
        (1.08, 1.0, 1.15)[variant],
        ("skin dark", "skin light", "skin medium")[variant],
        ("short", "bun", "bald")[variant],
        ("#15100d", "#7a4a24", "#1d1512")[variant],
        ("shirt", "shirt", "jacket")[variant],
        ("#e8e8e4", "#23262c", "#1c1d22")[variant],
        "trousers",
        ("#1d2026", "#23262c", "#1c1d22")[variant],
        "black",
    )
    at_ease = Pose((5, -5), (3, 3), (4, 4), (58, 58), 0.0, (20, 20))
    f = dressed(person, (STANDING, STEP, at_ease)[variant])
    b, h = f.builder, person.height
    belt(f)
    if variant < 2:
        cap(f, "#1d2026", ("police", "cap")[variant])
    if variant == 0:  # a tie, and epaulettes
        b.convex([tuple(f.trunk(z) + [x * h, y * h, 0]) for z, x, y in _TIE], "#1d2026")
        for side in (-1, 1):
            at = f.trunk(0.295) + [0, side * 0.085 * h, 0]
            b.box((0.05, 0.10, 0.012), tuple(at), "#1d2026", turn_deg=(side * -16, 0, 0), centered=True)
    else:
        vest(f, ("#c8d820", "#1c1d22")[variant - 1], ("light grey", "#2d3138")[variant - 1])
    ground = ("#e8e8e4", "#c8d820", "#1c1d22")[variant]
    badge_words(f, "SECURITY", ("#1d2026", "black", "white")[variant], ground, (0.070, 0.082, 0.084)[variant])
    b.box((0.05, 0.05, 0.16), tuple(f.trunk(0.0) + [0.0, -0.115 * h, -0.03]), "black", bevel=0.01)
    aerial = f.trunk(0.05) - [0.0, 0.115 * h, 0]
    b.rod(aerial, f.trunk(0.13) - [0.0, 0.115 * h, 0], 0.006, "black", sides=4)
    x, y, z = f.hands[0]
    b.rod((x - 0.06, y, z), (x + 0.20, y, z - 0.02), 0.020, "black", sides=8)  # a torch
    b.cylinder(0.032, 0.05, (x + 0.19, y, z - 0.02), "lamp", (0, 94, 0), segments=10)
    names = ("A security guard in a white shirt and cap", "A security guard in a vest", "A doorman in black")
    return finished(f, names[variant], ((0.38, 0.57, 1.80), (0, 0, 1.75), (0, 0, 1.86))[variant], dress=person.top)


_TIE_LEFT = ((0.295, 0.052, 0.012), (0.12, 0.070, 0.02), (0.10, 0.068, 0.004))
_TIE = (*((z, x, side * y) for z, x, y in _TIE_LEFT for side in (-1, 1)), (0.2, 0.078, 0.0))


@recipe("traffic controller", 3, name="guards.traffic_controller")
def traffic_controller(variant: int, rng: np.random.Generator) -> BuiltAsset:
    person = Person(
        (1.74, 1.70, 1.80)[variant],
        (1.05, 0.98, 1.1)[variant],
        ("skin medium", "skin light", "skin dark")[variant],
        ("short", "long", "short")[variant],
        ("#1e1612", "#a87a40", "#15100d")[variant],
        ("shirt", "jacket", "shirt")[variant],
        ("#24385c", "safety orange", "white")[variant],
        "trousers",
        ("#24385c", "#2a2d33", "#1d2026")[variant],
        "black",
    )
    poses = (
        Pose((3, -4), (4, 4), (4, 0), (12, 30), 0.0, (7, 15)),
        Pose((3, -4), (4, 4), (10, 20), (14, 20), 0.0, (9, 62)),
        Pose((3, -4), (4, 4), (62, 4), (14, 10), 0.0, (10, 78)),
    )
    f = dressed(person, poses[variant])
    b = f.builder
    vest(f, ("lime", "safety orange", "lime")[variant], "light grey")
    badge_words(f, "TRAFFIC", "black", ("lime", "safety orange", "lime")[variant], 0.084)
    cap(f, ("white", "signal yellow", "#1d2026")[variant], ("helmet", "helmet", "police")[variant])
    x, y, z = f.hands[1]
    if variant < 2:  # the stop paddle
        b.rod((x, y, z - 0.12), (x + 0.02, y - 0.05, z + 0.28), 0.014, "light wood", sides=6)
        angles = np.radians(22.5 + 45 * np.arange(8))
        outline = [(0.20 * np.cos(a), 0.20 * np.sin(a)) for a in angles]
        image, pen = paint.canvas((192, 192), "signal red")
        paint.text(pen, "STOP", (22, 56, 170, 136), "white", 0.05)
        b.plate(outline, 0.008, (x + 0.02, y - 0.05, z + 0.46), np.asarray(paint.shrunk(image, (48, 48))), "signal red")
    else:
        b.rod((x, y, z), (x + 0.04, y - 0.30, z + 0.22), 0.02, "light red", sides=8)
        for k in (0, 1):
            b.ball(0.045, tuple(f.hands[k]), "white", segments=8, rings=5)
    if variant == 1:
        backpack(f, "charcoal", 0.8)
    names = ("A traffic controller with a stop paddle", "A school crossing guard", "An officer directing traffic")
    return finished(f, names[variant], ((0.42, 0.72, 1.78), (0, 0, 1.76), (0.78, 0, 1.85))[variant])
