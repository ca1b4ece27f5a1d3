//! Contact with friction on dense matrices: projections, all combinations of states, closed forms, counts, hostile input.

mod cones;
mod counts;
mod deck;
mod dense;
mod dual;
mod enumeration;
mod hostile;
mod mindlin;
mod problem;
mod slides;
mod spheres;
mod states;
mod supports;
