"""What scenes composed by hand and procedural places are made of: a free plan, ground in layers, groups of objects."""
