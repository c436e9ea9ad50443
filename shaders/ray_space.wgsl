// ray_space
