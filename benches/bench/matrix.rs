//! The matrix that CHOLMOD factorises, in the file that `cholmod.c` reads; the problem, in that which `peers.py` reads.

use std::fs::File;
use std::io::{BufWriter, Error, Result, Write};
use std::path::Path;

use decks::{Body, Deck};

/// The block-diagonal K. `regular`: positive definite, max|K_ii| is added on the three dofs of a first, middle and
/// last node of every floating body. Otherwise f, B (pointers, columns, values) and c follow.
pub fn write(deck: &Deck, regular: bool, path: &Path) -> Result<()> {
    let (mut ptr, mut row, mut val) = (vec![0i32], Vec::new(), Vec::new());
    let mut offset = 0;
    for body in &deck.bodies {
        let (held, shift) = if regular { supports(body) } else { (Vec::new(), 0.0) };
        for j in 0..body.dofs() {
            // The upper part of row j is the lower part of column j.
            for (i, value) in body.stiffness.row(j).filter(|&(i, _)| i >= j) {
                row.push((offset + i) as i32);
                val.push(if i == j && held.contains(&j) { value + shift } else { value });
            }
            ptr.push(row.len() as i32);
        }
        offset += body.dofs();
    }
    // no pointer is larger
    i32::try_from(row.len()).map_err(|_| Error::other("K has more entries than numbers of 32 bits count"))?;
    let mut file = BufWriter::new(File::create(path)?);
    sizes(&mut file, offset, row.len())?;
    ptr.iter().chain(&row).try_for_each(|i| file.write_all(&i.to_ne_bytes()))?;
    numbers(&mut file, &val)?;
    if !regular {
        let b = &deck.contact.matrix;
        numbers(&mut file, &deck.load())?;
        sizes(&mut file, deck.contact.len(), b.col.len())?;
        b.ptr.iter().chain(&b.col).try_for_each(|&i| file.write_all(&(i as i32).to_ne_bytes()))?;
        numbers(&mut file, &b.val)?;
        numbers(&mut file, &deck.contact.rhs)?;
    }
    file.flush()
}

fn sizes(file: &mut impl Write, rows: usize, entries: usize) -> Result<()> {
    [rows, entries].iter().try_for_each(|&size| file.write_all(&(size as i64).to_ne_bytes()))
}

fn numbers(file: &mut impl Write, values: &[f64]) -> Result<()> {
    values.iter().try_for_each(|v| file.write_all(&v.to_ne_bytes()))
}

/// The dofs of three nodes of a floating body and max|K_ii|; none of a body that is held. The middle node of a block
/// with even numbers of elements lies between the first and the last, which would leave the spin about their line: the
/// next node is taken.
fn supports(body: &Body) -> (Vec<usize>, f64) {
    if body.modes().is_empty() {
        return (Vec::new(), 0.0);
    }
    let nodes = body.dofs() / 3;
    let held = [0, nodes / 2 + 1, nodes - 1].into_iter().flat_map(|node| 3 * node..3 * node + 3);
    let largest = body.stiffness.diagonal().iter().fold(0.0, |largest: f64, k| largest.max(k.abs()));
    (held.collect(), largest)
}
