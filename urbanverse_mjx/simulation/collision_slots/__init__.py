"""What is near the robot: static hulls, movable bodies and agents in fixed numbers of slots, and their contacts."""
