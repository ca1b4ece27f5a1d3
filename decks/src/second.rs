//! A second solver for small problems, in double-double arithmetic and by other means than the library: a proximal method of
//! multipliers whose strictly convex steps are solved by principal pivoting.
