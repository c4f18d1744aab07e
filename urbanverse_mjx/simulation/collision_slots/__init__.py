"""Collision slots: fixed numbers of static hulls, movable bodies and agents near the robot, and their contacts."""
