//! What a rank that serves keeps for rank 0, and its answers.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::body::elsewhere::{Assemble, Entries, Multiply, Question, Solve};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::lent::{Factorise, Made};
use crate::error::{Error, Kind, Result};
use crate::linalg::{Csr, Operator, Packed};
use crate::platform::memory::zeros;
use crate::platform::slabs::Slabs;
use crate::platform::threads;
use crate::ranks::{damaged, Wire};

/// Kinds of questions.
pub const QUESTIONS: usize = 5;

/// K+ and dual operators by their names.
#[derive(Default)]
pub struct Bodies {
    kplus: Mutex<Names<GeneralizedInverse>>,
    forms: Mutex<Names<Form>>,
    /// Questions of each kind so far.
    asked: [AtomicU64; QUESTIONS],
}

type Names<T> = HashMap<u64, Arc<T>>;

impl Bodies {
    /// Answers a list of questions, on so many threads.
    pub fn answer(&self, mut message: &[u8], threads: usize) -> Result<Vec<u8>> {
        let count = usize::take(&mut message)?;
        let tasks = (0..count).map(|_| Ok(Mutex::new(Some(Task::take(&mut message)?))));
        let tasks = tasks.collect::<Result<Vec<_>>>()?;
        let answers = threads::run(threads, count, |k| {
            let twice = || Error::new(Kind::Internal, "a question was answered twice");
            let task = tasks[k].lock().unwrap_or_else(PoisonError::into_inner).take();
            Ok(self.one(task.ok_or_else(twice)?))
        })?;
        let mut all = crate::ranks::message(&count);
        answers.into_iter().for_each(|answer| all.extend(answer));
        Ok(all)
    }

    /// What rank 0 no longer has goes.
    pub fn forget(&mut self, names: &[u64]) {
        let (kplus, forms) = (get_mut(&mut self.kplus), get_mut(&mut self.forms));
        names.iter().for_each(|name| drop((kplus.remove(name), forms.remove(name))));
    }

    /// Questions of each kind so far.
    pub fn asked(&self) -> [u64; QUESTIONS] {
        self.asked.each_ref().map(|count| count.load(Ordering::Relaxed))
    }

    /// Number of K+ and of dual operators that are kept.
    pub fn kept(&self) -> usize {
        of(&self.kplus).len() + of(&self.forms).len()
    }

    fn one(&self, task: Task) -> Vec<u8> {
        fn sent<T: Wire>(answer: Result<T>) -> Vec<u8> {
            crate::ranks::message(&answer)
        }
        match task {
            Task::Factorise(of) => self.count(Question::Factorise, sent(self.factorise(of))),
            Task::Assemble(of) => self.count(Question::Assemble, sent(self.assemble(of))),
            Task::Multiply(Multiply { form, exact, x }) => {
                let product = find(&self.forms, form).and_then(|form| form.product(&x, exact));
                self.count(Question::Multiply, sent(product))
            }
            Task::Entries(Entries { form, rows }) => {
                let block = find(&self.forms, form).and_then(|form| form.block(&rows));
                self.count(Question::Entries, sent(block))
            }
            Task::Solve(of) => self.count(Question::Solve, sent(self.solve(of))),
        }
    }

    fn count(&self, question: Question, answer: Vec<u8>) -> Vec<u8> {
        self.asked[question as usize].fetch_add(1, Ordering::Relaxed);
        answer
    }

    fn factorise(&self, Factorise { kplus, of, rounded, plan }: Factorise) -> Result<Made> {
        let plan = Arc::into_inner(plan).ok_or_else(damaged)?;
        if let Some(of) = of {
            let made = plan.with_factor_of(&*find(&self.kplus, of)?)?;
            let told = Made::of_shared(&made);
            keep(&self.kplus, kplus, made);
            return Ok(told);
        }
        let (planned, k) = (plan.symbolic().cloned(), rounded.then(|| plan.matrix().clone()));
        let mut made = plan.execute()?;
        if let Some(k) = k {
            made.inverse = made.inverse.rounded(&k, &Slabs::of(0)?)?;
        }
        let told = Made::of(&made, planned.as_ref());
        keep(&self.kplus, kplus, made.inverse);
        Ok(told)
    }

    fn assemble(&self, Assemble { kplus, form, explicit, rows }: Assemble) -> Result<()> {
        let made = Form::of(find(&self.kplus, kplus)?, rows, explicit)?;
        keep(&self.forms, form, made);
        Ok(())
    }

    fn solve(&self, Solve { kplus, exact, mut x }: Solve) -> Result<Vec<f64>> {
        let kplus = find(&self.kplus, kplus)?;
        if x.len() != kplus.null_space.rows {
            return Err(damaged());
        }
        kplus.solve_in_place(exact, &mut x)?;
        Ok(x)
    }
}

/// A question with its data.
enum Task {
    Factorise(Factorise),
    Assemble(Assemble),
    Multiply(Multiply),
    Entries(Entries),
    Solve(Solve),
}

impl Task {
    fn take(from: &mut &[u8]) -> Result<Self> {
        Ok(match Question::take(from)? {
            Question::Factorise => Self::Factorise(Wire::take(from)?),
            Question::Assemble => Self::Assemble(Wire::take(from)?),
            Question::Multiply => Self::Multiply(Wire::take(from)?),
            Question::Entries => Self::Entries(Wire::take(from)?),
            Question::Solve => Self::Solve(Wire::take(from)?),
        })
    }
}

/// `B K+ B'`, assembled or not.
enum Form {
    Explicit(Packed),
    Implicit { kplus: Arc<GeneralizedInverse>, rows: Arc<Csr> },
}

impl Form {
    fn of(kplus: Arc<GeneralizedInverse>, rows: Arc<Csr>, explicit: bool) -> Result<Self> {
        Ok(if explicit { Self::Explicit(kplus.inverse_form(&rows)?) } else { Self::Implicit { kplus, rows } })
    }

    fn order(&self) -> usize {
        match self {
            Self::Explicit(form) => form.order(),
            Self::Implicit { rows, .. } => rows.rows(),
        }
    }

    fn product(&self, x: &[f64], exact: bool) -> Result<Vec<f64>> {
        if x.len() != self.order() {
            return Err(damaged());
        }
        let mut image = zeros(x.len(), "a product with the dual operator")?;
        match self {
            Self::Explicit(form) => form.apply(x, &mut image),
            Self::Implicit { kplus, rows } => {
                let mut moved = zeros(rows.cols, "a product with the dual operator")?;
                rows.mul_transposed_add(1.0, x, &mut moved);
                kplus.solve_in_place(exact, &mut moved)?;
                rows.mul(&moved, &mut image);
            }
        }
        Ok(image)
    }

    fn block(&self, rows: &[usize]) -> Result<Packed> {
        if rows.iter().any(|row| *row >= self.order()) {
            return Err(damaged());
        }
        match self {
            Self::Explicit(form) => {
                let mut packed = Packed::zeros(rows.len())?;
                for (k, &i) in rows.iter().enumerate() {
                    rows[..=k].iter().enumerate().for_each(|(l, &j)| packed.add(k, l, form.get(i, j)));
                }
                Ok(packed)
            }
            Self::Implicit { kplus, rows: all } => {
                let mut selected = Csr::empty(all.cols);
                rows.iter().for_each(|&i| selected.push_row(all.row(i)));
                kplus.inverse_form(&selected)
            }
        }
    }
}

fn of<T>(names: &Mutex<Names<T>>) -> MutexGuard<'_, Names<T>> {
    names.lock().unwrap_or_else(PoisonError::into_inner)
}

fn get_mut<T>(names: &mut Mutex<Names<T>>) -> &mut Names<T> {
    names.get_mut().unwrap_or_else(PoisonError::into_inner)
}

fn find<T>(names: &Mutex<Names<T>>, name: u64) -> Result<Arc<T>> {
    let missing = || Error::new(Kind::Internal, "a rank does not have what rank 0 asks for");
    of(names).get(&name).cloned().ok_or_else(missing)
}

fn keep<T>(names: &Mutex<Names<T>>, name: u64, value: T) {
    of(names).insert(name, Arc::new(value));
}
