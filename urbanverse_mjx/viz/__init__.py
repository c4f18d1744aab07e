"""Images, galleries and videos of scenes and rollouts."""
