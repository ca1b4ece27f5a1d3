//! The answers of a rank that serves.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

use crate::body::boundary::boundary;
use crate::body::coarse::Coarse;
use crate::body::elsewhere::{
    Boundary, Enter, Entered, Entries, Give, GiveLoad, HostLoad, Join, Multiply, Name, NullSpace, Solve,
};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::given::Stiffness;
use crate::body::grounded::grounded;
use crate::body::layout::Symbolic;
use crate::body::lent::asked::Answering;
use crate::body::lent::member::{Member, WithMatrix};
use crate::body::lent::planned::{Analyse, Analysis, Factorise, Follow, PlanBody, PlanHere, Planned};
use crate::body::lent::Made;
use crate::body::store::Store;
use crate::body::Body;
use crate::error::{Error, Kind, Result};
use crate::linalg::{Csr, Operator, Packed};
use crate::platform::memory::zeros;
use crate::platform::slabs::Slabs;
use crate::platform::threads;
use crate::ranks::{damaged, Wire};

/// Kinds of questions.
pub const QUESTIONS: usize = Name::ALL.len();

/// Takes a question about a body of an island from a message.
pub type Taken = fn(Name, &mut &[u8]) -> Result<Box<dyn Answering>>;

/// K+, dual operators, bodies of islands and what is kept of these, by their names.
pub struct Bodies {
    store: Store,
    taken: Taken,
    /// Questions of each kind so far, and bytes of these and their answers.
    asked: [AtomicU64; QUESTIONS],
    bytes: [AtomicU64; QUESTIONS],
    /// Numbers of questions of this kind and of their answers are wrong in their last bit: for tests.
    #[cfg(feature = "loopback")]
    pub wrong: Option<Name>,
}

impl Bodies {
    pub fn new(taken: Taken) -> Self {
        let [asked, bytes] = [0; 2].map(|_| [const { AtomicU64::new(0) }; QUESTIONS]);
        Self {
            store: Store::default(),
            taken,
            asked,
            bytes,
            #[cfg(feature = "loopback")]
            wrong: None,
        }
    }

    /// Answers a list of questions, on so many threads.
    pub fn answer(&self, mut message: &[u8], threads: usize) -> Result<Vec<u8>> {
        let count = usize::take(&mut message)?;
        let tasks = (0..count).map(|_| Ok(Mutex::new(Some(self.take(&mut message)?))));
        let tasks = tasks.collect::<Result<Vec<_>>>()?;
        let answers = threads::run(threads, count, |k| {
            let twice = || Error::new(Kind::Internal, "a question was answered twice");
            let task = tasks[k].lock().unwrap_or_else(PoisonError::into_inner).take();
            let (name, task) = task.ok_or_else(twice)?;
            let answer = self.perhaps_wrong(name, || self.one(task));
            self.count(name, answer.len());
            Ok(answer)
        })?;
        let mut all = crate::ranks::message(&count);
        answers.into_iter().for_each(|answer| all.extend(answer));
        Ok(all)
    }

    /// Keeps a body that the host has given on this rank.
    pub fn keep_body(&self, name: u64, body: Body) {
        self.store.keep(name, body);
    }

    /// Keeps its load.
    pub fn keep_load(&self, name: u64, load: Option<Arc<[f64]>>) {
        self.store.keep(name, RwLock::new(HostLoad(load)));
    }

    /// Keeps a vector over the unknowns of a body.
    pub fn keep_vector(&self, name: u64, v: Vec<f64>) {
        self.store.keep(name, RwLock::new(v));
    }

    /// A vector over the unknowns of a body, which is no longer kept.
    pub fn taken_vector(&self, name: u64) -> Result<Vec<f64>> {
        let kept = self.store.find::<RwLock<Vec<f64>>>(name)?;
        self.store.forget(&[name]);
        let own = Arc::try_unwrap(kept).map(|own| own.into_inner().unwrap_or_else(PoisonError::into_inner));
        Ok(own.unwrap_or_else(|kept| kept.read().unwrap_or_else(PoisonError::into_inner).clone()))
    }

    /// A K+ that was made here, if rank 0 still has it.
    pub fn kplus_named(&self, name: u64) -> Option<Arc<GeneralizedInverse>> {
        self.kplus(name).ok().map(|with| Arc::clone(&with.kplus))
    }

    /// What rank 0 no longer has goes.
    pub fn forget(&self, names: &[u64]) {
        self.store.forget(names);
    }

    /// Questions of each kind so far.
    pub fn asked(&self) -> [u64; QUESTIONS] {
        self.asked.each_ref().map(|count| count.load(Ordering::Relaxed))
    }

    /// Bytes of the questions of each kind so far, and of their answers.
    pub fn bytes(&self) -> [u64; QUESTIONS] {
        self.bytes.each_ref().map(|count| count.load(Ordering::Relaxed))
    }

    fn count(&self, name: Name, bytes: usize) {
        self.bytes[name as usize].fetch_add(bytes as u64, Ordering::Relaxed);
    }

    /// Number of what is kept.
    pub fn kept(&self) -> usize {
        self.store.len()
    }

    fn take(&self, from: &mut &[u8]) -> Result<(Name, Task)> {
        let (name, before) = (Name::take(from)?, from.len());
        self.asked[name as usize].fetch_add(1, Ordering::Relaxed);
        let task = self.perhaps_wrong(name, || self.task(name, from))?;
        self.count(name, before - from.len());
        Ok((name, task))
    }

    #[cfg(feature = "loopback")]
    fn perhaps_wrong<T>(&self, name: Name, work: impl FnOnce() -> T) -> T {
        match self.wrong == Some(name) {
            true => crate::ranks::spoiling(work),
            false => work(),
        }
    }

    #[cfg(not(feature = "loopback"))]
    fn perhaps_wrong<T>(&self, _: Name, work: impl FnOnce() -> T) -> T {
        work()
    }

    fn task(&self, name: Name, from: &mut &[u8]) -> Result<Task> {
        Ok(match name {
            Name::Give => Task::Give(Wire::take(from)?),
            Name::GiveLoad => Task::GiveLoad(Wire::take(from)?),
            Name::Enter => Task::Enter(Wire::take(from)?),
            Name::Plan => Task::Plan(Wire::take(from)?),
            Name::Follow => Task::Follow(Wire::take(from)?),
            Name::Analyse => Task::Analyse(Wire::take(from)?),
            Name::Factorise => Task::Factorise(Wire::take(from)?),
            Name::Boundary => Task::Boundary(Wire::take(from)?),
            Name::Multiply => Task::Multiply(Wire::take(from)?),
            Name::Entries => Task::Entries(Wire::take(from)?),
            Name::Solve => Task::Solve(Wire::take(from)?),
            Name::NullSpace => Task::NullSpace(Wire::take(from)?),
            Name::Join => Task::Join(Wire::take(from)?),
            name => Task::Ask((self.taken)(name, from)?),
        })
    }

    fn one(&self, task: Task) -> Vec<u8> {
        fn sent<T: Wire>(answer: Result<T>) -> Vec<u8> {
            crate::ranks::message(&answer)
        }
        let form = |name| self.store.find::<Form>(name);
        match task {
            Task::Give(Give { name, body }) => {
                self.store.keep(name, body);
                sent(Ok(()))
            }
            Task::GiveLoad(GiveLoad { name, load }) => {
                self.store.keep(name, RwLock::new(HostLoad(load)));
                sent(Ok(()))
            }
            Task::Enter(of) => sent(self.enter(of)),
            Task::Plan(of) => sent(self.plan(of)),
            Task::Follow(of) => sent(self.follow(of)),
            Task::Analyse(of) => sent(self.analyse(of)),
            Task::Factorise(of) => sent(self.factorise(of)),
            Task::Boundary(of) => sent(self.boundary(of)),
            Task::Multiply(Multiply { form: name, share, x }) => {
                sent(form(name).and_then(|form| form.product(&x, share)))
            }
            Task::Entries(Entries { form: name, rows }) => {
                sent(form(name).and_then(|form| form.block(&rows)))
            }
            Task::Solve(of) => sent(self.solve(of)),
            Task::NullSpace(NullSpace { kplus }) => {
                sent(self.kplus(kplus).map(|of| of.kplus.null_space.clone()))
            }
            Task::Join(of) => sent(self.join(of)),
            Task::Ask(of) => of.answered(&self.store),
        }
    }

    fn kplus(&self, name: u64) -> Result<Arc<WithMatrix>> {
        self.store.find(name)
    }

    fn enter(&self, of: Enter) -> Result<Entered> {
        let (name, body) = (of.member, self.store.find::<Body>(of.body)?);
        let (member, entered) = Member::new(body, of)?;
        self.store.keep(name, member);
        Ok(entered)
    }

    fn plan(&self, PlanBody { plan: name, body, with }: PlanBody) -> Result<Planned> {
        let body = self.store.find::<Body>(body)?;
        let plan = body.plan(with)?;
        let told = Planned::from(&plan);
        self.store.keep(name, PlanHere::new(body, plan));
        Ok(told)
    }

    fn follow(&self, Follow { plan, layouts }: Follow) -> Result<Option<usize>> {
        self.store.find::<PlanHere>(plan)?.with(|plan| plan.follow_first(layouts.iter().map(|of| &**of)))
    }

    fn analyse(&self, Analyse { plan, symbolic: name }: Analyse) -> Result<Analysis> {
        let symbolic = self.store.find::<PlanHere>(plan)?.with(|plan| plan.analyse())?;
        let told = Analysis::from(&*symbolic);
        self.store.share(name, symbolic);
        Ok(told)
    }

    fn factorise(
        &self,
        Factorise { kplus, plan, symbolic, further, of, precision }: Factorise,
    ) -> Result<Made> {
        let planned = self.store.find::<PlanHere>(plan)?;
        let mut plan = planned.take()?;
        let k = Arc::clone(&plan.matrix().matrix);
        if let Some(of) = of {
            let made = plan.with_factor_of(&self.kplus(of)?.kplus)?;
            let told = Made::of_shared(&made);
            let grounded = grounded(Stiffness::Matrix(&k))?;
            self.store.keep(kplus, WithMatrix { kplus: Arc::new(made), k, grounded });
            return Ok(told);
        }
        let symbolic = self.store.find::<Symbolic>(symbolic)?;
        plan.set_analysis(Arc::clone(&symbolic));
        let made =
            plan.execute_in(precision, &Slabs::of(0)?).map_err(|error| planned.body.explained(error))?;
        let is_further = !Arc::ptr_eq(&made.symbolic, &symbolic);
        let told = Made::of(&made, is_further);
        if is_further {
            self.store.share(further, made.symbolic);
        }
        let grounded = grounded(Stiffness::Matrix(&k))?;
        self.store.keep(kplus, WithMatrix { kplus: Arc::new(made.inverse), k, grounded });
        Ok(told)
    }

    fn boundary(&self, Boundary { kplus, form, inside, scale, dofs }: Boundary) -> Result<()> {
        let k = &self.kplus(kplus)?.k;
        if dofs.iter().any(|dof| *dof >= k.order()) {
            return Err(damaged());
        }
        self.store.keep(form, Form::Boundary(boundary(k, inside, scale, &dofs)?));
        Ok(())
    }

    fn solve(&self, Solve { kplus, exact, mut x }: Solve) -> Result<Vec<f64>> {
        let kplus = &self.kplus(kplus)?.kplus;
        if x.len() != kplus.order() {
            return Err(damaged());
        }
        kplus.solve_in_place(exact.then_some(1.0), &mut x)?;
        Ok(x)
    }

    fn join(&self, mut of: Join) -> Result<Coarse> {
        let (name, with) = (of.member, self.kplus(of.kplus)?);
        if let Some(new) = of.form.take() {
            let form = Form::of(&with.kplus, &of.rows, new.explicit, new.rows)?;
            self.store.keep(new.name, form);
        }
        let (member, coarse) = self.store.find::<Member>(name)?.joined(with, of)?;
        self.store.keep(name, member);
        Ok(coarse)
    }
}

/// A question with its data.
enum Task {
    Give(Give),
    GiveLoad(GiveLoad),
    Enter(Enter),
    Plan(PlanBody),
    Follow(Follow),
    Analyse(Analyse),
    Factorise(Factorise),
    Boundary(Boundary),
    Multiply(Multiply),
    Entries(Entries),
    Solve(Solve),
    NullSpace(NullSpace),
    Join(Join),
    Ask(Box<dyn Answering>),
}

/// `B K+ B'`, assembled or not, or S_b.
enum Form {
    /// Products that are to be exact are those of K+ if its factor is rounded.
    Explicit(Packed, Option<(Arc<GeneralizedInverse>, Arc<Csr>)>),
    Implicit {
        kplus: Arc<GeneralizedInverse>,
        rows: Arc<Csr>,
    },
    Boundary(Box<dyn Operator + Send>),
}

impl Form {
    /// For these of the rows, or all.
    fn of(
        kplus: &Arc<GeneralizedInverse>,
        rows: &Arc<Csr>,
        explicit: bool,
        of: Option<Vec<usize>>,
    ) -> Result<Self> {
        let rows = match of {
            None => Arc::clone(rows),
            Some(of) => Arc::new(selected(rows, &of)?),
        };
        Ok(match explicit {
            true => {
                let exact = kplus.is_rounded().then(|| (Arc::clone(kplus), Arc::clone(&rows)));
                Self::Explicit(kplus.inverse_form(&rows)?, exact)
            }
            false => Self::Implicit { kplus: Arc::clone(kplus), rows },
        })
    }

    fn order(&self) -> usize {
        match self {
            Self::Explicit(form, _) => form.order(),
            Self::Implicit { rows, .. } => rows.rows(),
            Self::Boundary(form) => form.order(),
        }
    }

    fn product(&self, x: &[f64], share: Option<f64>) -> Result<Vec<f64>> {
        if x.len() != self.order() {
            return Err(damaged());
        }
        let form: &dyn Operator = match self {
            Self::Explicit(_, Some((kplus, rows))) if share.is_some() => {
                return kplus.product_between(rows, x, share);
            }
            Self::Implicit { kplus, rows } => return kplus.product_between(rows, x, share),
            Self::Explicit(form, _) => form,
            Self::Boundary(form) => &**form,
        };
        let mut image = zeros(x.len(), "a product with the dual operator")?;
        form.apply(x, &mut image);
        Ok(image)
    }

    fn block(&self, rows: &[usize]) -> Result<Packed> {
        match self {
            Self::Explicit(form, _) => {
                if rows.iter().any(|row| *row >= form.order()) {
                    return Err(damaged());
                }
                let mut packed = Packed::zeros(rows.len())?;
                for (k, &i) in rows.iter().enumerate() {
                    rows[..=k].iter().enumerate().for_each(|(l, &j)| packed.add(k, l, form.get(i, j)));
                }
                Ok(packed)
            }
            Self::Implicit { kplus, rows: all } => kplus.inverse_form(&selected(all, rows)?),
            Self::Boundary(_) => Err(damaged()),
        }
    }
}

/// These of the rows.
fn selected(rows: &Csr, of: &[usize]) -> Result<Csr> {
    if of.iter().any(|row| *row >= rows.rows()) {
        return Err(damaged());
    }
    let mut selected = Csr::empty(rows.cols);
    of.iter().for_each(|&i| selected.push_row(rows.row(i)));
    Ok(selected)
}
