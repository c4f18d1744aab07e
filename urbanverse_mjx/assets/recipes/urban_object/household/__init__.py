"""Recipes of kitchenware, vessels and cleaning equipment."""
