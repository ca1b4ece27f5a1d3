//! Optimality conditions solved dense, in double-double arithmetic, with the closed rows that an answer has: the signs of
//! forces and gaps of the result say whether these are right.

use decks::dd::Dd;
use decks::Deck;

/// Forces of the contact rows and displacements.
pub struct Truth {
    pub lambda: Vec<f64>,
    pub u: Vec<f64>,
}

/// `[K B_F'; B_F 0]`, F the rows with a force and the equality rows; fails where the signs refute the rows.
pub fn solve(deck: &Deck, closed: &[usize]) -> Result<Truth, String> {
    let n = deck.dofs();
    let rows: Vec<(Vec<(usize, f64)>, f64)> = closed
        .iter()
        .map(|&i| (deck.contact.matrix.row(i).collect(), deck.contact.rhs[i]))
        .chain(
            (0..deck.equalities.len())
                .map(|i| (deck.equalities.matrix.row(i).collect(), deck.equalities.rhs[i])),
        )
        .collect();
    let size = n + rows.len();
    let (mut a, mut b) = (vec![vec![Dd::ZERO; size]; size], vec![Dd::ZERO; size]);
    for (p, body) in deck.bodies.iter().enumerate() {
        let first = deck.offset(p);
        for i in 0..body.dofs() {
            body.stiffness.row(i).for_each(|(j, v)| a[first + i][first + j] = v.into());
            b[first + i] = body.load[i].into();
        }
    }
    for (k, (row, rhs)) in rows.iter().enumerate() {
        for &(j, v) in row {
            (a[n + k][j], a[j][n + k]) = (v.into(), v.into());
        }
        b[n + k] = (*rhs).into();
    }
    let x = eliminated(a, b).ok_or("the conditions are singular")?;
    let u = x[..n].to_vec();
    let mut lambda = vec![0.0; deck.contact.len()];
    closed.iter().zip(&x[n..]).for_each(|(&i, force)| lambda[i] = *force);
    let most = lambda.iter().fold(0.0, |most: f64, l| most.max(l.abs()));
    if let Some(i) = lambda.iter().position(|l| *l < -1e-9 * most) {
        return Err(format!("row {i} pulls: {:e}", lambda[i]));
    }
    let far = u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    for i in 0..lambda.len() {
        let open = deck.contact.rhs[i] - deck.contact.matrix.row(i).map(|(j, v)| v * u[j]).sum::<f64>();
        if open < -1e-9 * far {
            return Err(format!("row {i} is open by {open:e}"));
        }
    }
    Ok(Truth { lambda, u })
}

/// Gauss with pivots of columns.
fn eliminated(mut a: Vec<Vec<Dd>>, mut b: Vec<Dd>) -> Option<Vec<f64>> {
    let n = b.len();
    for k in 0..n {
        let best = (k..n).max_by(|&i, &j| a[i][k].abs().value().total_cmp(&a[j][k].abs().value()))?;
        a.swap(k, best);
        b.swap(k, best);
        if a[k][k].value() == 0.0 {
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
    Some(x.into_iter().map(Dd::value).collect())
}
