//! Rays, boxes and numbers of the field: the f64 side.
