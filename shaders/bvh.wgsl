// bvh
