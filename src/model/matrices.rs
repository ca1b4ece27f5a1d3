//! Stiffness matrices: first with their pattern, then new values only.

use std::sync::Arc;

use crate::body::{
    check_finite, from_borrowed, from_dense, from_sparse, from_split, same_matrix, same_pattern, Columns,
    Form, Places, Skyline, SkylineInput, SparseInput, Storage, TripletInput, Triplets,
};
use crate::error::{Error, Kind, Result};
use crate::linalg::hash::same_bits;
use crate::linalg::{Borrowed, Symmetric};
use crate::model::bodies::check_ld;
use crate::model::contents::Change;
use crate::model::host::HostModel;

impl HostModel {
    pub fn set_stiffness(&mut self, body: usize, k: SparseInput<'_>) -> Result<()> {
        self.check_length(body, "n", k.ptr.len() - 1)?;
        let stiffness = from_sparse(k, self.settings.symmetry_tolerance).map_err(|e| e.body(body))?;
        let form = Form::Sparse(Places::of(k, false, &stiffness)?);
        self.keep_stiffness(body, stiffness, form)
    }

    pub fn set_stiffness_split(&mut self, body: usize, diag: &[f64], k: SparseInput<'_>) -> Result<()> {
        self.check_length(body, "n", k.ptr.len() - 1)?;
        self.check_length(body, "n", diag.len())?;
        let tolerance = self.settings.symmetry_tolerance;
        let stiffness = from_split(k, diag, tolerance).map_err(|e| e.body(body))?;
        let form = Form::Sparse(Places::of(k, true, &stiffness)?);
        self.keep_stiffness(body, stiffness, form)
    }

    pub fn set_stiffness_skyline(
        &mut self,
        body: usize,
        diag: Option<&[f64]>,
        k: SkylineInput<'_>,
    ) -> Result<()> {
        self.check_length(body, "n", k.ptr.len() - 1)?;
        diag.map_or(Ok(()), |diag| self.check_length(body, "n", diag.len()))?;
        let (profile, stiffness) = Skyline::of(k, diag).map_err(|e| e.body(body))?;
        self.keep_stiffness(body, stiffness, Form::Skyline(profile))
    }

    pub fn set_stiffness_triplets(&mut self, body: usize, n: usize, k: TripletInput<'_>) -> Result<()> {
        self.check_length(body, "n", n)?;
        let tolerance = self.settings.symmetry_tolerance;
        let (triplets, stiffness) = Triplets::of(n, k, tolerance).map_err(|e| e.body(body))?;
        self.keep_stiffness(body, stiffness, Form::Triplets(triplets))
    }

    pub fn set_stiffness_dense(
        &mut self,
        body: usize,
        n: usize,
        k: &[f64],
        ld: usize,
        storage: Storage,
    ) -> Result<()> {
        self.check_length(body, "n", n)?;
        check_ld("ld", ld, n).map_err(|e| e.body(body))?;
        let tolerance = self.settings.symmetry_tolerance;
        let stiffness = from_dense(n, k, ld, storage, tolerance).map_err(|e| e.body(body))?;
        self.keep_stiffness(body, stiffness, Form::Dense(storage))
    }

    pub fn borrow_stiffness(
        &mut self,
        body: usize,
        ptr: &[usize],
        col: Columns<'_>,
        val: Borrowed<f64>,
    ) -> Result<bool> {
        self.check_length(body, "n", ptr.len() - 1)?;
        let Some(k) = from_borrowed(ptr, col, val).map_err(|e| e.body(body))? else { return Ok(false) };
        let form = Form::Sparse(Places::of_lower(&k));
        self.keep_stiffness(body, k, form)?;
        Ok(true)
    }

    fn keep_stiffness(&mut self, body: usize, stiffness: Symmetric, form: Form) -> Result<()> {
        let old = self.given(body)?.body.stiffness.as_ref();
        // borrowed columns may be the array given now, so they cannot be compared
        let old = old.filter(|old| !old.col.is_of_host());
        let change = match old {
            Some(old) if !old.val.is_of_host() && same_matrix(old, &stiffness) => Change::Nothing,
            Some(old) if same_pattern(old, &stiffness) => Change::Values,
            _ => Change::Pattern,
        };
        let given = self.change(body, change)?;
        given.body.stiffness = Some(Arc::new(stiffness));
        (given.body.other, given.mesh) = (None, None);
        given.form = Some(Box::new(form));
        given.spoiled = false;
        Ok(())
    }

    pub fn values(&self, body: usize, split: bool) -> Result<usize> {
        let form = self.form(body)?;
        form.values(split).ok_or_else(|| another_call(body, form))
    }

    pub fn set_values(&mut self, body: usize, val: &[f64]) -> Result<()> {
        self.give_values(body, None, val)
    }

    pub fn set_values_split(&mut self, body: usize, diag: &[f64], val: &[f64]) -> Result<()> {
        self.give_values(body, Some(diag), val)
    }

    pub fn set_values_dense(&mut self, body: usize, n: usize, k: &[f64], ld: usize) -> Result<()> {
        let storage = self.dense_storage(body)?;
        self.set_stiffness_dense(body, n, k, ld, storage)
    }

    pub fn dense_storage(&self, body: usize) -> Result<Storage> {
        match self.form(body)? {
            Form::Dense(storage) => Ok(*storage),
            form => Err(another_call(body, form)),
        }
    }

    fn give_values(&mut self, body: usize, diag: Option<&[f64]>, val: &[f64]) -> Result<()> {
        self.check_values(body, diag.is_some(), val.len())?;
        diag.map_or(Ok(()), |diag| self.check_length(body, "n", diag.len()))?;
        let (k, form, diag) = (self.stiffness(body)?, self.form(body)?, diag.unwrap_or(&[]));
        let new = form.new_values(k, diag, val, self.settings.symmetry_tolerance);
        let Some(new) = new.map_err(|e| e.body(body))? else { return self.grow(body, diag, val) };
        let stiffness = self.bodies[body].body.stiffness.as_mut();
        let k = Arc::make_mut(stiffness.ok_or_else(|| not_given(body))?);
        let old = k.replace_values(new);
        let unchanged = same_bits(&old, &k.val);
        self.change(body, Change::unless(unchanged, Change::Values)).map(drop)
    }

    /// Values of a profile with entries that its matrix does not have.
    fn grow(&mut self, body: usize, diag: &[f64], val: &[f64]) -> Result<()> {
        let Form::Skyline(profile) = self.form(body)? else { return Err(not_given(body)) };
        let stiffness = Arc::new(profile.matrix(diag, val).map_err(|e| e.body(body))?);
        let given = self.change(body, Change::Pattern)?;
        given.body.stiffness = Some(stiffness);
        if let Some(Form::Skyline(profile)) = given.form.as_deref_mut() {
            profile.has_grown = true;
        }
        Ok(())
    }

    fn check_values(&self, body: usize, split: bool, values: usize) -> Result<()> {
        let entries = self.values(body, split)?;
        if values == entries {
            return Ok(());
        }
        let error = Error::argument("nnz", format!("the pattern has {entries} entries, not {values}"));
        Err(error.body(body).value(values as f64).limit(entries as f64))
    }

    pub fn is_borrowed(&self, body: usize) -> bool {
        self.stiffness(body).is_ok_and(|k| k.val.is_of_host())
    }

    pub fn borrow_values(&mut self, body: usize, val: Borrowed<f64>) -> Result<()> {
        self.check_values(body, false, val.len())?;
        let stiffness = self.bodies[body].body.stiffness.as_mut();
        let k = Arc::make_mut(stiffness.ok_or_else(|| not_given(body))?);
        let old = k.replace_values(val);
        let row_of = |at: usize| k.ptr.partition_point(|&start| start <= at) - 1;
        let checked = check_finite(&k.val, "val", row_of);
        let (array, rewritten) = (k.val.as_ptr(), k.val.as_ptr() == old.as_ptr());
        if checked.is_err() {
            k.replace_values(old);
        }
        let borrows = |p: &usize| {
            let k = self.bodies[*p].body.stiffness.as_ref();
            k.is_some_and(|k| k.val.is_of_host() && k.val.as_ptr() == array)
        };
        let bodies: Vec<usize> = (0..self.bodies.len()).filter(borrows).collect();
        for p in bodies.into_iter().filter(|_| checked.is_ok() || rewritten) {
            self.change(p, Change::Values)?.spoiled = checked.is_err();
        }
        checked.map_err(|e| e.body(body))
    }

    fn stiffness(&self, body: usize) -> Result<&Symmetric> {
        self.given(body)?.body.stiffness.as_deref().ok_or_else(|| not_given(body))
    }

    fn form(&self, body: usize) -> Result<&Form> {
        self.given(body)?.form.as_deref().ok_or_else(|| not_given(body))
    }
}

fn not_given(body: usize) -> Error {
    let what = "the stiffness matrix has not been given: call feti_body_stiffness before its values";
    Error::new(Kind::State, what).body(body)
}

fn another_call(body: usize, form: &Form) -> Error {
    let (given, call) = form.told();
    let what = format!("the stiffness matrix was given {given}: give new values by {call}");
    Error::new(Kind::State, what).body(body)
}
