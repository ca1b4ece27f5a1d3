mod claims;
mod guests;
mod meshes;
