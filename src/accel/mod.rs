//! Acceleration structures.
