"""Options of the planner."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class PlannerOptions:
    """Sampled commands and cost weights.

    Chosen manually; docs/results.md has the planner's scores.

    Attributes:
      steps: s, times of the predictions at `reference_speed`; between two of them a robot moves less than its length.
      first_steps: number of predictions in the first phase.
      reference_speed: m/s, upper limit of all robots' speeds; for slower robots the prediction after the first phase
        covers the same distance.
      speeds: shares of the top speed in the first phase.
      turns: shares of the top yaw rate in the first phase.
      later_speeds: shares of the top speed in the second phase.
      later_turns: shares of the top yaw rate in the second phase.
      follow_speeds: shares of the top speed at which the second phase may also descend the field.
      follow_gain: (rad/s) / rad, gain of the descent.
      nose: m in front of the robot, distance of additional samples of the field, so that the heading affects the cost.
      nose_angle: rad, angle of these samples to both sides.
      nose_clearance: m, distance from hulls and edges that leaves the way to these samples free; on the way there are
        three points so close together that none passes between them.
      max_slope: limit of the ground's slope in the model of the robot's motion.
      touch_distance: m, distance below which the robot counts as touching.
      margin: m, distance to obstacles below which there is a cost.
      margin_time: s, increase of the margin with the speed.
      margin_cost: cost of a second at distance 0 at 2 m/s (the cost per metre does not depend on the speed).
      touch_cost: cost of immediate contact.
      goal_distance: m, remaining route that counts as arrived.
      edge_distance: m, distance of wheels to an edge.
      agent_distance: m, distance to agents.
      agent_drift: m/s, increase of that distance with the prediction time, for the uncertainty of their motion.
      standing: m/s and rad/s, speeds below which the robot stands.
      mean_weight: weight of the mean remaining distance in the cost, so that of two commands with equal ends the faster
        one is better.
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
    nose_clearance: float = 0.05
    max_slope: float = 0.25
    touch_distance: float = 0.02
    margin: float = 0.10
    margin_time: float = 0.08
    margin_cost: float = 20.0
    touch_cost: float = 1000.0
    goal_distance: float = 0.6
    edge_distance: float = 0.04
    agent_distance: float = 0.15
    agent_drift: float = 0.1
    standing: float = 0.1
    mean_weight: float = 1.0
