"""Options of the renderer, and the constants of its images."""

import dataclasses

#: Labels in "object" and "category" of the sky and of the robot's own pixels.
SKY_LABEL = -1
ROBOT_LABEL = -2
#: "object" of the first moving agent, the k-th after it has k less; its "category" is that of its appearance.
AGENT_LABEL = -3
#: "pbr": glTF materials as mujoco-warp-pbr shows them; "matte": the same light without highlights.
SHADINGS = ("pbr", "matte")
#: "direct": sun and sky reach every surface that faces them (the sun: unless `shadows`); "baked": less what the street
#: hides, computed once for each scene, and what moves nearby.
LIGHTS = ("direct", "baked")
OUTPUTS = ("rgb", "depth", "category", "object", "normal")
#: What else can be asked for: no image, but numbers of pixels.
COVERAGE = "coverage"
#: Display colour of the sky where none is drawn (sky=False).
PLAIN_SKY = (0.62, 0.74, 0.88, 1.0)
#: The tone mapper subtracts the light that gloss adds to every surface, which darkens shade; this factor compensates.
#: Chosen visually on the shipped streets.
PBR_EXPOSURE = 1.3
#: Height (m) of invisible geoms, deep under every street.
NOWHERE = -1.0e4


@dataclasses.dataclass(frozen=True)
class Scan:
    """Rays of a LiDAR in place of a camera's: image rows are rings from `upper` down to `lower` (rad above the level of
    the sensor), columns are azimuths from the back over the left side, the front and the right side; range: m;
    elevations: of every ring (rad), where they are not evenly spaced."""

    upper: float
    lower: float
    range: float
    elevations: tuple[float, ...] = ()


@dataclasses.dataclass(frozen=True)
class Settings:
    """Options of rendering.

    outputs: of `OUTPUTS`, and `COVERAGE`; samples: rays per pixel along each side; appearance: share by
    which appearances vary; bodies: objects of a scene that may have moved; scan: None for a camera; light: of
    `LIGHTS`; see `Renderer`.
    """

    height: int
    width: int
    outputs: tuple[str, ...]
    shadows: bool
    sky: bool
    samples: int
    shading: str
    appearance: float = 0.0
    bodies: int = 0
    scan: Scan | None = None
    light: str = "direct"
