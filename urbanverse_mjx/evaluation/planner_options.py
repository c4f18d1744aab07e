"""Sampled commands and cost weights of the planner."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class PlannerOptions:
    """Sampled commands and cost weights.

    Set by hand; docs/results.md has the planner's scores.

    Attributes:
      steps: s of each prediction at `reference_speed`: between two of them a robot moves less than its length.
      first_steps: how many of them the first phase lasts.
      reference_speed: m/s, upper limit of all robots' speeds; for slower robots the prediction after the first phase
        covers the same distance.
      speeds: shares of the top speed in the first phase.
      turns: shares of the top yaw rate in the first phase.
      later_speeds: shares of the top speed in the second phase.
      later_turns: shares of the top yaw rate in the second phase.
      follow_speeds: shares of the top speed at which the second phase may also follow the field downhill.
      follow_gain: (rad/s) / rad of that.
      nose: m ahead of the robot of further samples of the field, which make its heading count.
      nose_angle: rad to both sides of it.
      touch_distance: m; nearer than this counts as touching.
      margin: m, distance below which nearness has a cost.
      margin_time: m more per m/s.
      margin_cost: of a second at distance 0 at 2 m/s (the cost per metre is the same at lower speed).
      touch_cost: of touching at once.
      goal_distance: m of route left that still count as arrived.
      edge_distance: m that wheels keep from an edge.
      agent_distance: m to keep from agents.
      agent_drift: m more per second ahead, for the uncertainty of their motion.
      mean_weight: share of the mean distance left in the cost: of two commands with equal ends the faster one is
        better.
    """

    steps: tuple[float, ...] = (0.2, 0.2, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3)
    first_steps: int = 2
    reference_speed: float = 2.0
    speeds: tuple[float, ...] = (0.0, 0.2, 0.4, 0.7, 1.0)
    turns: tuple[float, ...] = (-1.0, -0.6, -0.25, 0.0, 0.25, 0.6, 1.0)
    later_speeds: tuple[float, ...] = (0.0, 0.35, 1.0)
    later_turns: tuple[float, ...] = (-1.0, -0.4, 0.0, 0.4, 1.0)
    follow_speeds: tuple[float, ...] = (0.15, 0.35, 0.6, 1.0)
    follow_gain: float = 2.5
    nose: float = 0.6
    nose_angle: float = 0.6
    touch_distance: float = 0.02
    margin: float = 0.10
    margin_time: float = 0.08
    margin_cost: float = 20.0
    touch_cost: float = 1000.0
    goal_distance: float = 0.6
    edge_distance: float = 0.04
    agent_distance: float = 0.15
    agent_drift: float = 0.1
    mean_weight: float = 1.0
