"""Camera images: the render model of a bank, and the kernels that draw the streets of a batch of envs."""
