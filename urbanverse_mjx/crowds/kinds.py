"""The kinds of moving agents: sizes, speeds and limits, each number with its source.

In: none; this is data. Out:  `AgentKind`, and `KINDS` by name. When: at construction.
"""

import dataclasses

from ..datatypes import validation as v

#: Surfaces on which agents may be, by kinds of ground (datatypes/ground.py).
SURFACES = {
    "foot": ("sidewalk", "crosswalk", "ground"),
    "road": ("road", "road_marking", "crosswalk"),
}


@dataclasses.dataclass(frozen=True)
class AgentKind:
    """One kind of road user. Its body is a capsule: a disc drawn along a segment (a disc where half_length is 0).

    Attributes:
      name: name of the kind.
      surface: row of `SURFACES`.
      radius: m.
      half_length: m, from the centre to the centre of the front disc.
      margin: m, free distance around the body if there is room.
      speed: m/s, mean of the preferred speed over people.
      spread: m/s, its standard deviation.
      speed_limit: m/s, never exceeded.
      headroom: factor on the preferred speed that is allowed to let others pass.
      acceleration, braking: m/s².
      wheeled: whether it moves along its heading only; others move in any direction within the limits of acceleration
        and braking. The following limits apply to wheeled kinds:
      turn_radius: m, least radius of its path.
      pivot: rad/s, how fast it turns on the spot.
      turn_rate: rad/s, largest.
      lateral: m/s², largest in a curve.
      horizon: s, time for which it avoids others.
      wall_horizon: s, the same for static obstacles.
      height: m, height of the collision body.
      yielding: weight of its share of a pair's avoidance relative to the other's.
    """

    name: str
    surface: str
    radius: float
    half_length: float
    margin: float
    speed: float
    spread: float
    speed_limit: float
    headroom: float
    acceleration: float
    braking: float
    wheeled: bool
    turn_radius: float
    pivot: float
    turn_rate: float
    lateral: float
    horizon: float
    wall_horizon: float
    height: float
    yielding: float = 1.0

    def __post_init__(self) -> None:
        v.choice(self.surface, f"kind {self.name!r}: surface", SURFACES)
        for field in dataclasses.fields(self):
            if field.type is float:
                least = {"above": 0.0}
                if field.name in ("half_length", "margin", "spread", "pivot", "yielding"):
                    least = {"minimum": 0.0}
                v.number(getattr(self, field.name), f"kind {self.name!r}: {field.name}", **least)

    @property
    def size(self) -> float:
        """m, radius of the disc around the whole body."""
        return self.radius + self.half_length


#: m/s², braking of cars on a dry road: the value for stopping sight distances in AASHTO's Green Book, which most
#: drivers exceed in an emergency.
_CAR_BRAKING = 3.4

PEDESTRIAN = AgentKind(
    "pedestrian",
    "foot",
    # A disc with the area of the 0.50 m x 0.60 m body ellipse of the Highway Capacity Manual 2000.
    radius=0.27,
    half_length=0.0,
    # Half of the 0.15-0.25 m that Weidmann (1993) finds between passing people and edges.
    margin=0.08,
    # Weidmann, "Transporttechnik der Fussgänger" (1993): 1.34 m/s, standard deviation 0.26 m/s.
    speed=1.34,
    spread=0.26,
    # Weidmann (1993): mean and three standard deviations.
    speed_limit=2.1,
    headroom=1.3,
    # Moussaïd et al., Proc. R. Soc. B 276 (2009): speeds relax within 0.54 s; 1.34 m/s / 0.54 s.
    acceleration=2.5,
    braking=2.5,
    wheeled=False,
    turn_radius=0.1,
    pivot=6.0,
    turn_rate=6.0,
    lateral=2.5,
    # Karamouzas, Skinner and Guy, Phys. Rev. Lett. 113 (2014): people interact up to some 3 s ahead of a collision.
    horizon=3.0,
    # Shorter towards walls, as in the examples of the published library: one walks along them, not away from them.
    wall_horizon=0.8,
    # NCD Risk Factor Collaboration, eLife 5 (2016): women and men born in 1996 average about 1.65 and 1.77 m in
    # much of Europe and North America; a body is as high as its shape here.
    height=1.72,
)
WHEELCHAIR = AgentKind(
    "wheelchair",
    "foot",
    # ISO 7193: an occupied wheelchair takes at most 0.70 m x 1.20 m; a disc of that area has a radius of 0.52 m, and as
    # one turned with its way takes less across, 0.46 m. It turns on the spot, so it may move in any direction.
    radius=0.46,
    half_length=0.0,
    margin=0.08,
    # Weidmann's pedestrians at 2/3 of their speed: manual and powered chairs on level ground (assumed; powered ones
    # are limited to 6 km/h on pavements in most of Europe).
    speed=0.9,
    spread=0.25,
    speed_limit=1.67,
    headroom=1.2,
    acceleration=0.8,
    braking=1.6,
    wheeled=False,
    turn_radius=0.3,
    pivot=1.0,
    turn_rate=1.0,
    lateral=1.5,
    horizon=3.0,
    wall_horizon=1.0,
    # ISO 7193: at most 1.09 m for the chair; a seated person's head reaches about 1.3 m.
    height=1.3,
)
SCOOTER = AgentKind(
    "scooter",
    "foot",
    # German eKFV § 1: at most 0.70 m wide, 20 km/h; a common one is 1.15 m long. With a foot on the ground it turns on
    # the spot, and while driving its rider can lean quickly, so it is modelled as a disc of 0.40 m.
    radius=0.40,
    half_length=0.0,
    margin=0.1,
    # Cicchino et al. (2023), sidewalks of Austin: 41 % at 4.5 m/s or more and 9 % at 6.7 m/s or more, which for a
    # normal distribution is 4.0 m/s; their spread of 2 m/s is cut by the limit.
    speed=4.0,
    spread=1.0,
    speed_limit=5.56,
    headroom=1.1,
    acceleration=1.0,
    # eKFV § 4: brakes of at least 3.5 m/s².
    braking=3.5,
    wheeled=False,
    turn_radius=1.2,
    pivot=0.8,
    turn_rate=2.5,
    lateral=2.5,
    horizon=3.0,
    wall_horizon=1.2,
    # A pedestrian on a deck 0.15 m above the road.
    height=1.85,
)
CYCLIST = AgentKind(
    "cyclist",
    "road",
    # AASHTO Guide for the Development of Bicycle Facilities (2012): 0.75 m x 1.80 m.
    radius=0.375,
    half_length=0.525,
    margin=0.1,
    # Parkin and Rotheram (2010): on the flat 85 % ride at most 22 km/h = 6.1 m/s, acceleration 0.231 m/s²; with a
    # spread like that of walking speeds (16-19 %) the mean is 5.2 m/s.
    speed=5.2,
    spread=0.9,
    speed_limit=7.0,
    headroom=1.1,
    acceleration=0.23,
    # AASHTO (2012) designs stopping sights with a friction of 0.32.
    braking=3.1,
    wheeled=True,
    turn_radius=2.0,
    pivot=0.5,
    turn_rate=1.5,
    lateral=2.5,
    horizon=3.5,
    wall_horizon=2.0,
    # AASHTO (2012): the operating height is 2.5 m with clearance; the rider's eyes are at 1.5 m, the head above.
    height=1.7,
)
CAR = AgentKind(
    "car",
    "road",
    # FGSV design vehicle (2005): 4.74 m x 1.76 m, outer turning radius 5.85 m.
    radius=0.88,
    half_length=1.49,
    margin=0.2,
    # A 30 km/h zone; drivers spread by about 10 %.
    speed=7.5,
    spread=0.8,
    speed_limit=8.33,
    headroom=1.0,
    # Treiber and Kesting, "Traffic Flow Dynamics" (2013), city traffic of the Intelligent Driver Model.
    acceleration=1.0,
    braking=_CAR_BRAKING,
    wheeled=True,
    turn_radius=4.97,
    pivot=0.0,
    turn_rate=1.0,
    lateral=2.0,
    horizon=4.0,
    wall_horizon=2.5,
    # FGSV design vehicle (2005).
    height=1.51,
)
KINDS = {kind.name: kind for kind in (PEDESTRIAN, WHEELCHAIR, SCOOTER, CYCLIST, CAR)}
