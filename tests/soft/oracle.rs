//! Optimality conditions solved dense, in double-double arithmetic, with the closed rows that an answer has: the signs of
//! forces and gaps of the result say whether these are right.

use decks::yardstick::Answer;
use decks::Deck;

use crate::support::face;

/// On the closed contact rows and the equality rows; fails where the signs refute the rows.
pub fn solve(deck: &Deck, closed: &[usize]) -> Result<Answer, String> {
    let truth = face::answer(deck, closed, 0.0).ok_or("the conditions are singular")?;
    let (u, lambda) = (&truth.u, &truth.lambda);
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
    Ok(truth)
}
