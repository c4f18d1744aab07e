"""Visual geoms of the Go2: trunk, head, motors and legs from MuJoCo's primitive shapes, placed manually.

In:   the side of a leg.
Out:  MJCF text of geoms that neither collide nor weigh anything.
"""

_GREY, _DARK, _BLACK, _GLOW = "shell", "joint", "rubber", "light"


def materials() -> str:
    """The materials that the geoms name."""
    return "\n    ".join(
        f'<material name="{name}" rgba="{rgba}" specular="{specular}" shininess="{specular}"/>'
        for name, rgba, specular in (
            (_GREY, "0.66 0.68 0.70 1", 0.5),
            (_DARK, "0.13 0.13 0.14 1", 0.4),
            (_BLACK, "0.05 0.05 0.05 1", 0.1),
            (_GLOW, "0.75 0.90 1.0 1", 0.9),
        )
    )


def _geom(kind: str, size: str, material: str, place: str) -> str:
    return f'<geom class="visual" type="{kind}" size="{size}" material="{material}" {place}/>'


def base_appearance() -> str:
    """Geoms of the trunk and the head."""
    return "".join(
        (
            _geom("box", "0.19 0.062 0.05", _GREY, 'pos="0 0 0.004"'),
            _geom("ellipsoid", "0.2 0.075 0.03", _GREY, 'pos="0 0 0.05"'),
            _geom("box", "0.16 0.07 0.02", _DARK, 'pos="0 0 -0.052"'),
            _geom("capsule", "0.045", _DARK, 'fromto="0.193 -0.045 0 0.193 0.045 0"'),
            _geom("capsule", "0.045", _DARK, 'fromto="-0.193 -0.045 0 -0.193 0.045 0"'),
            _geom("box", "0.05 0.035 0.03", _DARK, 'pos="0.245 0 0.01"'),
            _geom("ellipsoid", "0.055 0.05 0.055", _GREY, 'pos="0.285 0 0.012"'),
            _geom("ellipsoid", "0.035 0.043 0.04", _BLACK, 'pos="0.31 0 0.0"'),
            _geom("cylinder", "0.014 0.004", _GLOW, 'pos="0.343 0 0.012" zaxis="1 0 0"'),
            _geom("sphere", "0.04", _BLACK, 'pos="0.293 0 -0.058"'),
        )
    )


def leg_appearance(left: float) -> dict[str, str]:
    """Link name -> geoms; left is 1 or -1."""
    y = 0.08 * left
    return {
        "hip": _geom("cylinder", "0.047 0.03", _GREY, f'pos="0 {y} 0" zaxis="0 1 0"')
        + _geom("capsule", "0.036", _DARK, f'fromto="0 0 0 0 {y} 0"'),
        "thigh": _geom("cylinder", "0.045 0.018", _DARK, f'pos="0 {0.012 * left} 0" zaxis="0 1 0"')
        + _geom("capsule", "0.028", _GREY, 'fromto="-0.004 0 -0.03 -0.006 0 -0.12"')
        + _geom("capsule", "0.02", _GREY, 'fromto="-0.006 0 -0.12 0 0 -0.2"')
        + _geom("cylinder", "0.024 0.018", _DARK, 'pos="0 0 -0.213" zaxis="0 1 0"'),
        "calf": _geom("capsule", "0.013", _DARK, 'fromto="0.004 0 -0.01 0.016 0 -0.11"')
        + _geom("capsule", "0.011", _DARK, 'fromto="0.016 0 -0.11 0.002 0 -0.2"')
        + _geom("sphere", "0.022", _BLACK, 'pos="-0.002 0 -0.213"'),
    }
