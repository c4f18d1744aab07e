"""Pictures, galleries and videos of scenes and rollouts."""
