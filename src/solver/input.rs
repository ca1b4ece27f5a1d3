//! The input of a host: methods of its model under their names, described here.

use std::path::Path;

use crate::body::{Columns, HostFunctions, Modes, SkylineInput, SparseInput, Storage, TripletInput};
use crate::constraints::{DofTableInput, FrictionInput, RowKind, RowsInput};
use crate::error::Result;
use crate::linalg::Borrowed;
use crate::mesh::ElementStorage;
use crate::model::{PairMethod, Settings, Sizes, SurfaceSizes};
use crate::platform::memory::Headroom;
use crate::solver::Problem;
use crate::surface::{RigidShape, Shape};

/// Methods that call those of the model: first the changes, then the rest.
macro_rules! input {
    (changes: $($(#[$doc:meta])* fn $change:ident(&mut self $(, $a:ident: $t:ty)*) $(-> $r:ty)?;)+
     reads: $($(#[$of:meta])* fn $read:ident(&self $(, $b:ident: $s:ty)*) -> $q:ty;)+) => {
        impl Problem {
            $($(#[$doc])* pub fn $change(&mut self $(, $a: $t)*) $(-> $r)? { self.model.$change($($a),*) })+
            $($(#[$of])* pub fn $read(&self $(, $b: $s)*) -> $q { self.model.$read($($b),*) })+
        }
    };
}

input! {
    changes:

    /// Sets a real option by its name; [`options`](crate::solver::options) lists all with ranges and defaults.
    fn set_f64(&mut self, name: &str, value: f64) -> Result<()>;

    /// Sets an integer option.
    fn set_i64(&mut self, name: &str, value: i64) -> Result<()>;

    /// Adds a body with `n` unknowns and returns its number.
    fn add_body(&mut self, n: usize) -> Result<usize>;

    /// R, n x r column-major with leading dimension `ldr`; r = 0 with exact vectors means that K is not singular.
    fn set_null_space(&mut self, body: usize, n: usize, r: usize, basis: &[f64], ldr: usize,
        modes: Modes) -> Result<()>;

    /// The dofs held in K+ of (15); none: the library chooses them. They change neither forces nor displacements, only
    /// the course of the methods in paper units.
    fn set_fixing(&mut self, body: usize, dofs: Option<&[usize]>) -> Result<()>;

    /// Node, direction and position of every dof; `xyz[k + ld i]` is coordinate k < dim of dof i.
    fn set_coordinates(&mut self, body: usize, dim: usize, node: &[i32], dir: &[i32], xyz: &[f64],
        ld: usize) -> Result<()>;

    /// What the rigid motions of the coordinates, given before or later, are; without this call candidates.
    fn set_coordinate_modes(&mut self, body: usize, modes: Modes) -> Result<()>;

    /// `f_p`, length n, force.
    fn set_load(&mut self, body: usize, f: &[f64]) -> Result<()>;

    /// `diagonal` is `K_ii`, n numbers >= 0, force / length; a matrix or functions given before are replaced.
    fn set_operator(&mut self, body: usize, diagonal: &[f64], functions: HostFunctions) -> Result<()>;

    /// `K_p` by rows, n x n.
    fn set_stiffness(&mut self, body: usize, k: SparseInput<'_>) -> Result<()>;

    /// `K_p` by rows without its diagonal `diag`, length n.
    fn set_stiffness_split(&mut self, body: usize, diag: &[f64], k: SparseInput<'_>) -> Result<()>;

    /// `K_p` by the columns of its upper triangle, each from its first entry on, with its diagonal in them or in `diag`, length n. Zeros beside
    /// the diagonal are no entries of `K_p`.
    fn set_stiffness_skyline(&mut self, body: usize, diag: Option<&[f64]>, k: SkylineInput<'_>) -> Result<()>;

    /// `K_p` by triplets in any order, n x n; values at one place are added, in the order of the triplets.
    fn set_stiffness_triplets(&mut self, body: usize, n: usize, k: TripletInput<'_>) -> Result<()>;

    /// `K_p` column-major with leading dimension `ld`, n x n.
    fn set_stiffness_dense(&mut self, body: usize, n: usize, k: &[f64], ld: usize,
        storage: Storage) -> Result<()>;

    /// `K_p` by the rows of its lower triangle; the values remain in the array of the host. Returns false without any
    /// change if the rows do not have the form in which the matrix is stored.
    fn borrow_stiffness(&mut self, body: usize, ptr: &[usize], col: Columns<'_>,
        val: Borrowed<f64>) -> Result<bool>;

    /// New values for the pattern given last, in the host's order; the analysis is kept. If a value of a profile was 0 and is not any more,
    /// the pattern changes, and the analysis with it; a value that becomes 0 stays an entry.
    fn set_values(&mut self, body: usize, val: &[f64]) -> Result<()>;

    /// As `set_values`, for a matrix without its diagonal `diag`, length n.
    fn set_values_split(&mut self, body: usize, diag: &[f64], val: &[f64]) -> Result<()>;

    /// A new matrix in the storage of the previous one. If entries change between zero and nonzero, the pattern changes,
    /// and the analysis with it.
    fn set_values_dense(&mut self, body: usize, n: usize, k: &[f64], ld: usize) -> Result<()>;

    /// New values for a matrix with borrowed values, in this array from now on. They count as changed, also for other
    /// bodies that borrow the array. If they are refused and the array is the previous one, there is no matrix until
    /// values are given again.
    fn borrow_values(&mut self, body: usize, val: Borrowed<f64>) -> Result<()>;

    /// The elements of a body: element e joins `dof[ptr[e]..ptr[e + 1]]`, from 0; -1 - k is the held unknown k, whose row
    /// and column are left out. A matrix or functions given before are replaced. If the elements are unchanged they are
    /// kept, and a new pass begins.
    fn set_mesh(&mut self, body: usize, ptr: &[usize], dof: &[i64]) -> Result<()>;

    /// The matrix of element e, n x n column-major with leading dimension `ld`.
    fn add_element(&mut self, body: usize, e: usize, n: usize, ke: &[f64], ld: usize) -> Result<()>;

    /// The matrices of `count` elements from `first` on, one after the other.
    fn add_elements(&mut self, body: usize, first: usize, count: usize, ke: &[f64],
        storage: ElementStorage) -> Result<()>;

    /// Sets the host's numbers of the unknowns of a body, from 0, distinct within the body, and over all bodies without
    /// glue. A second call replaces them.
    fn set_numbering(&mut self, body: usize, numbers: &[i64]) -> Result<()>;

    /// Sets the loads of all bodies, force; entries of `f` without unknown are ignored. If several unknowns share a
    /// number, the first gets the load.
    fn set_all_loads(&mut self, f: &[f64]) -> Result<()>;

    /// The host's unknowns, of which those without number in K are combinations of others: `u = T v + g`. Rows without `body` name unknowns
    /// of the table from now on, and arrays over all unknowns have its length. Another call replaces it: rows of the table follow.
    fn set_dof_table(&mut self, table: DofTableInput<'_>) -> Result<()>;

    /// Adds rows and returns the number of the first among those of its kind. Without `body`, their unknowns are the
    /// host's numbers if there are any.
    fn add_rows(&mut self, kind: RowKind, rows: RowsInput<'_>) -> Result<usize>;

    /// New right-hand sides c or h, length; a contact row whose gap is +infinity never closes.
    fn set_rhs(&mut self, kind: RowKind, first: usize, rhs: &[f64]) -> Result<()>;

    /// Makes rows from `first` on compliant, `B u - c <= lambda/k`, `H u - h = mu/k`: 1/k >= 0, length / force, 0 for
    /// rigid rows. The multipliers of the last solve remain valid as a start.
    fn set_compliance(&mut self, kind: RowKind, first: usize, inv_k: &[f64]) -> Result<()>;

    /// Drops all rows of one kind but those of pairs; with contact rows also all nodes with friction but those of pairs.
    fn clear_rows(&mut self, kind: RowKind);

    /// Adds nodes with friction and returns the number of the first. Without `body`, the unknowns of their tangential
    /// rows are the host's numbers if there are any.
    fn add_friction(&mut self, input: FrictionInput) -> Result<usize>;

    /// Sets coefficients (no unit), bounds (force) or both of `count` nodes; absent values do not change.
    fn set_friction_law(&mut self, first: usize, count: usize, coefficient: Option<&[f64]>,
        bound: Option<&[f64]>) -> Result<()>;

    /// Elastic stick, `s = T u - s_old - C_t lambda_t`: C_t >= 0, length / force, one per node; 0 for rigid nodes.
    fn set_friction_compliance(&mut self, first: usize, inv_kt: &[f64]) -> Result<()>;

    /// Sets s_old of `count` nodes, (dim, nodes), length: the slip at the start of the step.
    fn set_friction_reference(&mut self, first: usize, count: usize, dim: usize, s_old: &[f64]) -> Result<()>;

    /// Drops all nodes with friction but those of pairs; their contact rows remain.
    fn clear_friction(&mut self);

    /// Adds a surface over nodes at `x` (columns of `ldx` numbers, length) and returns its number. `dof`, with its columns, is the unknown of
    /// each direction in the body, below 0 for held ones; without `body` they are the host's numbers, or unknowns of all bodies in sequence.
    /// Without `dof` it is a tool that nothing moves but the host, the master of its pairs.
    fn surface_add(&mut self, body: Option<usize>, dim: usize, x: &[f64], ldx: usize,
        dof: Option<(&[i64], usize)>) -> Result<usize>;

    /// Adds faces of one shape to a surface, before its pairs, and returns the number of the first. Seen from outside of the body the corners
    /// go counterclockwise; in the plane the body is on the left. A surface without faces is a cloud of points, which may be a slave.
    fn surface_faces(&mut self, surface: usize, shape: Shape, node: &[i64]) -> Result<usize>;

    /// Makes a surface a cloud of these nodes alone; more calls add nodes.
    fn surface_points(&mut self, surface: usize, node: &[i64]) -> Result<()>;

    /// Adds a rigid plane (point, outward normal), sphere or circle (centre, radius) or cylinder (point, axis, radius); with a radius below 0
    /// the body is outside of it.
    fn surface_rigid(&mut self, dim: usize, shape: RigidShape, data: &[f64]) -> Result<usize>;

    /// New positions of all nodes, or new data of a rigid surface; rows do not change before the next find.
    fn surface_move(&mut self, surface: usize, x: &[f64], ldx: usize) -> Result<()>;

    /// Adds a pair and returns its number and its first row. It has one contact row for each slave node in a face (or in a cloud), ascending;
    /// a tie has an equality row for each direction of such a node. The numbers never change: pairs come before rows of the host. Nodes have
    /// a partner up to `distance`, length.
    fn pair_add(&mut self, slave: usize, master: usize, method: PairMethod, is_tied: bool,
        distance: f64) -> Result<(usize, usize)>;

    /// Sets a number of a pair by its name. One number, or one for each slave node: `friction`, `cohesion` (shear per area at pressure 0),
    /// `offset` (length, subtracted from gaps), `compliance` (length per pressure). One number: `adjust` (gaps of the first find up to this
    /// length count as 0), `on`, `angle` (degrees between outward normals, at least), `depth` (deepest penetration that is believed, length),
    /// `thickness` (plane), `axisymmetric` (the area is thickness times the first coordinate).
    fn pair_set(&mut self, pair: usize, name: &str, value: &[f64]) -> Result<()>;

    /// The next load step begins at the present positions; nodes keep no faces.
    fn pairs_commit(&mut self) -> Result<()>;

    reads:

    /// The value of a real option.
    fn get_f64(&self, name: &str) -> Result<f64>;

    /// The value of an integer option.
    fn get_i64(&self, name: &str) -> Result<i64>;

    /// The value of an option as a text.
    fn get_str(&self, name: &str) -> Result<String>;

    /// All options.
    fn settings(&self) -> &Settings;

    /// Numbers of bodies, unknowns, rows and nodes with friction.
    fn sizes(&self) -> Sizes;

    /// Number of unknowns of a body.
    fn order(&self, body: usize) -> Result<usize>;

    /// Number of values of a matrix by rows, by its profile or by triplets, without those of a separate diagonal (`split`).
    fn values(&self, body: usize, split: bool) -> Result<usize>;

    /// The storage of a dense matrix.
    #[doc(hidden)]
    fn dense_storage(&self, body: usize) -> Result<Storage>;

    /// Whether the values of the matrix remain in an array of the host.
    #[doc(hidden)]
    fn is_borrowed(&self, body: usize) -> bool;

    /// Number of values of the matrices of `count` elements.
    #[doc(hidden)]
    fn values_of_elements(&self, body: usize, first: usize, count: usize,
        storage: ElementStorage) -> Result<usize>;

    /// Number of unknowns of an element, including held unknowns.
    #[doc(hidden)]
    fn size_of_element(&self, body: usize, e: usize) -> Result<usize>;

    /// Checks that the body has an element with this number, the first of a block.
    #[doc(hidden)]
    fn check_first_element(&self, body: usize, first: usize) -> Result<()>;

    /// Checks the length of an array over all unknowns: at least the largest number + 1; without numbers, the sum over
    /// all bodies.
    #[doc(hidden)]
    fn check_whole(&self, n: usize) -> Result<()>;

    /// Passes the values of all bodies, one after the other, with their positions in an array over all unknowns; if
    /// several unknowns share a number, only the first.
    fn spread(&self, values: &[f64], to: impl FnMut(usize, f64)) -> Result<()>;

    /// Passes the displacements of all unknowns of the host, also those that the table eliminates, with their positions.
    fn spread_displacement(&self, u: &[f64], to: impl FnMut(usize, f64)) -> Result<()>;

    /// Values over all unknowns; the values of unknowns with the same number are summed at the first of them.
    fn summed(&self, values: Vec<f64>) -> Result<Vec<f64>>;

    /// Checks that `count` nodes exist and have `dim` tangential rows each.
    #[doc(hidden)]
    fn check_friction_nodes(&self, first: usize, count: usize, dim: usize) -> Result<()>;

    /// Dimensions, nodes and faces of a surface, and how many numbers describe a rigid one.
    fn surface_sizes(&self, surface: usize) -> Result<SurfaceSizes>;

    /// Checks that pairs have a number of this name, and that `n` numbers may give it.
    #[doc(hidden)]
    fn check_pair_number(&self, pair: usize, name: &str, n: usize) -> Result<()>;

    /// Reserves memory for further rows: existing rows may be copied while their arrays grow.
    #[doc(hidden)]
    fn headroom_for_rows(&self, rows: usize, entries: usize) -> Result<Headroom>;
}

impl Problem {
    /// Sets an option by its word or text.
    pub fn set_str(&mut self, name: &str, value: &str) -> Result<()> {
        self.set_options("value", |model| model.set_str(name, value))
    }

    /// Sets options by a text such as `tolerance=1e-8 threads=4`: all of them or none.
    pub fn set_text(&mut self, text: &str) -> Result<()> {
        self.set_options("text", |model| model.set_text(text))
    }

    /// Takes over the content of a file. The problem must be empty; after an error it is still empty. Options are those
    /// of the file, all others have their defaults; `index_base`, `log_file` and `log_level` are unchanged.
    pub fn read_file(&mut self, path: &Path) -> Result<()> {
        self.check_read_together()?;
        self.model.read_file(path)
    }

    /// As `read_file`, from bytes in memory.
    pub fn read_bytes(&mut self, bytes: &[u8]) -> Result<()> {
        self.model.read_bytes(bytes)
    }

    /// Writes all input to a new file, which replaces an old one when it is complete.
    pub fn write_file(&mut self, path: &Path) -> Result<()> {
        match self.write_together(path)? {
            true => Ok(()),
            false => self.model.write_file(path),
        }
    }

    /// The bytes that `write_file` writes.
    pub fn write_bytes(&self) -> Result<Vec<u8>> {
        self.check_alone()?;
        self.model.write_bytes()
    }
}
