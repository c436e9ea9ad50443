//! The image of a 3-D edge in the parameter plane of a surface.
