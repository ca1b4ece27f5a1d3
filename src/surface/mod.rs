//! Surfaces of bodies: faces, the point of a face nearest to a node, rows of contact between nodes and faces. Knows no bodies and no
//! solver: rows are over nodes of surfaces and directions.
//!
//! | module | holds |
//! |---|---|
//! | `vector` | points and vectors |
//! | `shape`, `patch`, `domain` | shape functions; one face with its positions; where a foot may lie |
//! | `faces`, `order`, `areas` | the faces of a surface, checked, whether their nodes are in order, normals and areas of nodes |
//! | `rigid` | plane, sphere, cylinder |
//! | `tree` | faces in boxes, nearest first |
//! | `foot`, `find` | the foot of a node on a face, and the partner of every node |
//! | `frame`, `rows` | directions that turn with the master; rows, gaps and slips |
//! | `mortar` | weighted gaps: segments of slave and master, dual functions, their rows |

mod areas;
mod domain;
mod faces;
mod find;
mod foot;
mod frame;
mod meeting;
mod mortar;
mod order;
mod patch;
mod rigid;
mod rows;
mod shape;
mod tree;
pub mod vector;

pub use areas::{areas, Depth};
pub use faces::{Faces, NONE};
pub use find::{between_walls, find, Master, Partner, Rule};
pub use foot::{Foot, Node, Placed};
pub use meeting::Meeting;
pub use mortar::Mortar;
pub use rigid::{Rigid, RigidFoot, RigidShape};
pub use rows::{Entry, Opposite, Rows, Slave};
pub use shape::Shape;
pub use tree::Tree;

#[cfg(test)]
mod tests;
