//! Vectors, boxes, rays, frames and the newtypes of indices.

mod aabb;
mod digest;
mod frame;
mod index;
mod order;
mod ray;

pub use aabb::Aabb;
pub use digest::Digest;
pub use frame::{Frame, turn_upright};
pub use glam::{
    Affine3A, DAffine3, DMat3, DQuat, DVec2, DVec3, Mat3, Mat4, Quat, Vec2, Vec3, Vec4,
};
pub use index::{InstanceId, MaterialId, MeshId, NodeId, PrimId, TextureId, TriangleId};
pub use order::{larger, smaller};
pub use ray::Ray;
