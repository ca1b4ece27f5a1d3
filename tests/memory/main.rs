//! Memory that the library takes: for a file with wrong counts, and for many parts. In a process of its own: the bytes in use are
//! counted over all threads, so nothing beside these tests may keep more than kilobytes.

mod counted;
mod files;
mod parts;
