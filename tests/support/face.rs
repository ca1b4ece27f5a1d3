//! Optimality conditions on the rows that an answer has closed, solved dense in double-double arithmetic: an oracle of several
//! programs.

use decks::dd::Dd;
use decks::yardstick::Answer;
use decks::Deck;

/// `[K B_F' H'; B_F -C; H -C]`, F the closed contact rows; none where it is singular: a pivot, of rows and columns of size 1, is not
/// above `least`.
pub fn answer(deck: &Deck, closed: &[usize], least: f64) -> Option<Answer> {
    let n = deck.dofs();
    let contact = closed.iter().map(|&i| (&deck.contact, i));
    let rows: Vec<_> = contact.chain((0..deck.equalities.len()).map(|i| (&deck.equalities, i))).collect();
    let size = n + rows.len();
    let (mut a, mut b) = (vec![vec![Dd::ZERO; size]; size], vec![Dd::ZERO; size]);
    for (p, body) in deck.bodies.iter().enumerate() {
        let first = deck.offset(p);
        for i in 0..body.dofs() {
            body.stiffness.row(i).for_each(|(j, v)| a[first + i][first + j] = v.into());
            b[first + i] = body.load[i].into();
        }
    }
    for (k, &(set, i)) in rows.iter().enumerate() {
        for (j, v) in set.matrix.row(i) {
            (a[n + k][j], a[j][n + k]) = (v.into(), v.into());
        }
        a[n + k][n + k] = (-set.compliance[i]).into();
        b[n + k] = set.rhs[i].into();
    }
    let x = eliminated(a, b, least)?;
    let mut lambda = vec![0.0; deck.contact.len()];
    closed.iter().zip(&x[n..]).for_each(|(&i, force)| lambda[i] = *force);
    Some(Answer { u: x[..n].to_vec(), lambda, mu: x[n + closed.len()..].to_vec() })
}

/// Gauss with pivots of columns, rows and columns of a symmetric matrix scaled to unit size.
fn eliminated(mut a: Vec<Vec<Dd>>, mut b: Vec<Dd>, least: f64) -> Option<Vec<f64>> {
    let n = b.len();
    let largest = |row: &Vec<Dd>| row.iter().map(|v| v.value().abs()).fold(0.0, f64::max);
    let size: Vec<f64> = a.iter().map(|row| largest(row).sqrt()).collect();
    if size.contains(&0.0) {
        return None;
    }
    for i in 0..n {
        (0..n).for_each(|j| a[i][j] = a[i][j] / Dd::product(size[i], size[j]));
        b[i] = b[i] / size[i].into();
    }
    for k in 0..n {
        let best = (k..n).max_by(|&i, &j| a[i][k].abs().value().total_cmp(&a[j][k].abs().value()))?;
        a.swap(k, best);
        b.swap(k, best);
        if a[k][k].value().abs() <= least {
            return None;
        }
        let (pivot, rest) = a[k..].split_first_mut()?;
        for (i, row) in rest.iter_mut().enumerate().filter(|(_, row)| row[k].value() != 0.0) {
            let factor = row[k] / pivot[k];
            (k..n).for_each(|j| row[j] = row[j] - factor * pivot[j]);
            b[k + 1 + i] = b[k + 1 + i] - factor * b[k];
        }
    }
    let mut x = vec![Dd::ZERO; n];
    for k in (0..n).rev() {
        let mut rest = b[k];
        (k + 1..n).for_each(|j| rest = rest - a[k][j] * x[j]);
        x[k] = rest / a[k][k];
    }
    Some((0..n).map(|i| (x[i] / size[i].into()).value()).collect())
}
