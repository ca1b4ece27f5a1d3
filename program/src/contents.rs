//! The content of a problem file, section by section (docs/file_format.md), as the library has written it.

use feti_contact::solver::Problem;

/// A sparse matrix by rows.
#[derive(Debug, Clone, Default)]
pub struct Matrix {
    pub ptr: Vec<usize>,
    pub col: Vec<usize>,
    pub val: Vec<f64>,
}

impl Matrix {
    pub fn rows(&self) -> usize {
        self.ptr.len().saturating_sub(1)
    }

    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        (self.ptr[i]..self.ptr[i + 1]).map(|k| (self.col[k], self.val[k]))
    }
}

/// Meaning of the motions of a body, as the file numbers it.
pub const MODES: [&str; 3] = ["exact", "candidates", "soft"];

#[derive(Debug, Default)]
pub struct Motions {
    pub modes: usize,
    /// By columns.
    pub basis: Vec<f64>,
    pub columns: usize,
}

#[derive(Debug, Default)]
pub struct Body {
    pub n: usize,
    /// The lower triangle of K; of a body in pieces their sum.
    pub k: Matrix,
    pub pieces: usize,
    pub motions: Option<Motions>,
    /// x, y, z of every unknown, and its direction: 1 to 3 along, 4 to 6 about the axes.
    pub xyz: Option<(Vec<f64>, Vec<i32>)>,
    /// What the motions of the coordinates are.
    pub xyz_modes: usize,
    pub load: Vec<f64>,
    pub fixing: bool,
    pub numbered: bool,
}

#[derive(Debug, Default)]
pub struct Rows {
    /// Columns count through all bodies.
    pub matrix: Matrix,
    pub rhs: Vec<f64>,
    pub inv_k: Vec<f64>,
}

#[derive(Debug, Default)]
pub struct Friction {
    pub dim: usize,
    /// -1: none.
    pub normal: Vec<i64>,
    pub matrix: Matrix,
    pub coefficient: Vec<f64>,
    pub bound: Vec<f64>,
    pub inv_kt: Vec<f64>,
    pub s_old: Vec<f64>,
}

#[derive(Debug, Default)]
pub struct Contents {
    pub options: String,
    pub bodies: Vec<Body>,
    /// First unknown of every body, and the number of all.
    pub starts: Vec<usize>,
    /// Contact rows, equality rows.
    pub rows: [Rows; 2],
    pub friction: Friction,
}

impl Contents {
    pub fn of(problem: &Problem) -> Result<Self, String> {
        let bytes = problem.write_bytes().map_err(|error| error.to_string())?;
        Self::parse(&bytes)
            .ok_or_else(|| "the library has written a file that this program cannot read".to_owned())
    }

    fn parse(bytes: &[u8]) -> Option<Self> {
        let mut all = Self { starts: vec![0], ..Self::default() };
        let mut left = Bytes(bytes.get(32..)?);
        while !left.0.is_empty() {
            let tag = left.take(4)?;
            left.take(4)?;
            let length = left.size()?;
            let mut of = Bytes(left.take(length)?);
            left.take((length + 4).next_multiple_of(8) - length)?;
            all.section(tag, &mut of)?;
        }
        Some(all)
    }

    fn section(&mut self, tag: &[u8], of: &mut Bytes) -> Option<()> {
        match tag {
            b"OPTS" => self.options = String::from_utf8_lossy(of.0).into_owned(),
            b"BODY" => {
                let n = of.size()?;
                self.bodies.push(Body { n, pieces: 1, load: vec![0.0; n], xyz_modes: 1, ..Body::default() });
                self.starts.push(self.starts.last()? + n);
            }
            b"ROWS" => {
                let kind = of.size()?.checked_sub(1)?;
                let (rows, entries) = (of.size()?, of.size()?);
                let matrix = of.matrix(rows, entries)?;
                *self.rows.get_mut(kind)? = Rows { matrix, rhs: of.reals(rows)?, inv_k: of.reals(rows)? };
            }
            b"FRIC" => {
                let (dim, nodes, entries) = (of.size()?, of.size()?, of.size()?);
                let normal = of.numbers(nodes, i64::from_le_bytes)?;
                let matrix = of.matrix(dim * nodes, entries)?;
                self.friction = Friction {
                    dim,
                    normal,
                    matrix,
                    coefficient: of.reals(nodes)?,
                    bound: of.reals(nodes)?,
                    inv_kt: of.reals(nodes)?,
                    s_old: of.reals(dim * nodes)?,
                };
            }
            _ => self.bodies.last_mut()?.section(tag, of)?,
        }
        Some(())
    }

    /// Body of an unknown that counts through all bodies.
    pub fn body_of(&self, unknown: usize) -> usize {
        self.starts[1..].partition_point(|end| *end <= unknown)
    }

    /// What a folder of .mtx files cannot have.
    pub fn left_out(&self) -> String {
        let any = |has: fn(&Body) -> bool| self.bodies.iter().any(has);
        let kinds = [
            (any(|body| body.fixing), "fixing unknowns"),
            (any(|body| body.numbered), "numbers of unknowns"),
            (any(|body| body.xyz.is_some() && body.xyz_modes != 1), "the kind of the motions of coordinates"),
            (any(|body| body.pieces > 1), "the pieces of bodies (K is their sum)"),
        ];
        kinds.iter().filter(|(left, _)| *left).map(|(_, what)| *what).collect::<Vec<_>>().join(", ")
    }
}

impl Body {
    fn section(&mut self, tag: &[u8], of: &mut Bytes) -> Option<()> {
        let n = of.size()?;
        match tag {
            b"STIF" => {
                let entries = of.size()?;
                self.k.ptr = of.sizes(n + 1)?;
                self.k.val = of.reals(entries)?;
                self.k.col = of.numbers(entries, |bytes| u32::from_le_bytes(bytes) as usize)?;
            }
            // n is the number of pieces
            b"PIEC" => self.pieces(n, of)?,
            b"NULL" => {
                let (columns, modes) = (of.size()?, of.size()?);
                self.motions = Some(Motions { modes, columns, basis: of.reals(n.checked_mul(columns)?)? });
            }
            b"COOR" => self.xyz = Some((of.reals(3 * n)?, of.numbers(n, i32::from_le_bytes)?)),
            b"COOF" => self.xyz_modes = n,
            b"LOAD" => self.load = of.reals(n)?,
            b"FIXD" => self.fixing = n > 0,
            b"NUMB" => self.numbered = true,
            _ => {}
        }
        Some(())
    }

    /// The sum of the pieces, in their order.
    fn pieces(&mut self, count: usize, of: &mut Bytes) -> Option<()> {
        let (rows, entries) = (of.size()?, of.size()?);
        let (first, unknown) = (of.sizes(count + 1)?, of.sizes(rows)?);
        let ptr = of.sizes(rows + 1)?;
        let val = of.reals(entries)?;
        let col = of.numbers(entries, u32::from_le_bytes)?;
        let mut sums = vec![std::collections::BTreeMap::new(); self.n];
        for piece in first.windows(2) {
            for i in piece[0]..piece[1] {
                for k in ptr[i]..ptr[i + 1] {
                    let j = *unknown.get(piece[0] + col[k] as usize)?;
                    *sums.get_mut(unknown[i].max(j))?.entry(unknown[i].min(j)).or_insert(0.0) += val[k];
                }
            }
        }
        self.pieces = count;
        self.k.ptr.push(0);
        for row in sums {
            self.k.col.extend(row.keys());
            self.k.val.extend(row.values());
            self.k.ptr.push(self.k.col.len());
        }
        Some(())
    }

    pub fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.n];
        for i in 0..self.k.rows() {
            self.k.row(i).filter(|(j, _)| *j == i).for_each(|(_, value)| diagonal[i] += value);
        }
        diagonal
    }

    /// K x, and the sum of |K_ij x_j| of each row.
    pub fn product(&self, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut y, mut size) = (vec![0.0; self.n], vec![0.0; self.n]);
        let mut add = |i: usize, term: f64| {
            y[i] += term;
            size[i] += term.abs();
        };
        for i in 0..self.k.rows() {
            for (j, value) in self.k.row(i) {
                add(i, value * x[j]);
                if i != j {
                    add(j, value * x[i]);
                }
            }
        }
        (y, size)
    }
}

/// Bytes that have not been read.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, left) = self.0.split_at_checked(count)?;
        self.0 = left;
        Some(taken)
    }

    fn size(&mut self) -> Option<usize> {
        usize::try_from(u64::from_le_bytes(self.take(8)?.try_into().ok()?)).ok()
    }

    fn numbers<T, const N: usize>(&mut self, count: usize, number: impl Fn([u8; N]) -> T) -> Option<Vec<T>> {
        let bytes = self.take(count.checked_mul(N)?)?;
        bytes.chunks_exact(N).map(|bytes| bytes.try_into().ok().map(&number)).collect()
    }

    fn sizes(&mut self, count: usize) -> Option<Vec<usize>> {
        self.numbers(count, |bytes| u64::from_le_bytes(bytes) as usize)
    }

    fn reals(&mut self, count: usize) -> Option<Vec<f64>> {
        self.numbers(count, f64::from_le_bytes)
    }

    fn matrix(&mut self, rows: usize, entries: usize) -> Option<Matrix> {
        Some(Matrix { ptr: self.sizes(rows + 1)?, col: self.sizes(entries)?, val: self.reals(entries)? })
    }
}
