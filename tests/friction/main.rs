//! Contact with friction on dense matrices: projections, all combinations of states, closed forms, counts, hostile input.

mod counts;
mod deck;
mod dense;
mod enumeration;
mod problem;
mod states;
